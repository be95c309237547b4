// Random numbers with one answer on every machine: a 64-bit linear congruential generator (Knuth's constants), of
// which the top 24 bits are used.
#pragma once

#include <cstdint>

namespace motley::bench {

class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    /// Uniform in [0, 1).
    double uniform()
    {
        state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
        return static_cast<double>(state_ >> 40) / 16777216.0;
    }
    /// Uniform in [-1, 1).
    double symmetric() { return 2 * uniform() - 1; }

  private:
    std::uint64_t state_;
};

}  // namespace motley::bench
