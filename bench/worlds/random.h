// Random numbers with one answer on every machine: a 64-bit linear congruential generator (Knuth's constants), of
// which the top 24 bits are used.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

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

/// Shuffles values, always into the same order.
template <class T>
void shuffle(std::vector<T>& values)
{
    Random random(12345);
    for (std::size_t i = values.size(); i-- > 1;)
        std::swap(values[i], values[static_cast<std::size_t>(random.uniform() * static_cast<double>(i + 1))]);
}

}  // namespace motley::bench
