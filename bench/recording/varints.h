// Whole numbers in as many bytes as they need, seven bits a byte, as in LEB128. Signed ones are folded first: 0, -1, 1, -2, ...
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

namespace motley::bench {

inline void put_unsigned(std::string& bytes, std::uint64_t value)
{
    for (; value >= 0x80; value >>= 7) bytes.push_back(static_cast<char>(value | 0x80));
    bytes.push_back(static_cast<char>(value));
}
inline void put_signed(std::string& bytes, std::int64_t value)
{
    put_unsigned(bytes, static_cast<std::uint64_t>(value) << 1 ^ static_cast<std::uint64_t>(value >> 63));
}

/// Takes numbers from bytes, one after the other. Throws std::runtime_error where they end too early.
class Bytes {
  public:
    explicit Bytes(std::span<const unsigned char> bytes) : bytes_(bytes) {}
    [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
    std::uint8_t byte()
    {
        if (left() == 0) throw std::runtime_error("ends too early");
        return bytes_[at_++];
    }
    std::uint64_t unsigned_number()
    {
        std::uint64_t value = 0;
        for (int shift = 0; shift < 64; shift += 7) {
            const std::uint8_t next = byte();
            value |= static_cast<std::uint64_t>(next & 0x7F) << shift;
            if (next < 0x80) return value;
        }
        throw std::runtime_error("has a number of more than 64 bits");
    }
    std::int64_t signed_number()
    {
        const std::uint64_t folded = unsigned_number();
        return static_cast<std::int64_t>(folded >> 1 ^ (0 - (folded & 1)));
    }
    /// A number of things of which each takes at least `least` bytes: more than that many cannot follow.
    std::size_t count(std::size_t least)
    {
        const std::uint64_t value = unsigned_number();
        if (value > left() / least) throw std::runtime_error("claims more than it has");
        return static_cast<std::size_t>(value);
    }

  private:
    std::span<const unsigned char> bytes_;
    std::size_t at_ = 0;
};

}  // namespace motley::bench
