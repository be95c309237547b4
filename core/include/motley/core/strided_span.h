// A view of equally spaced elements inside arrays that the host owns and lays out as it likes.
#pragma once

#include <cstddef>
#include <span>
#include <type_traits>

#pragma GCC visibility push(default)
namespace motley {

/// `size` elements of type T, `stride` bytes apart. Made from a std::span (its stride is sizeof(T)), or from a member
/// of an array of structs: StridedSpan<Vec3<float>>(&agents[0].velocity, agents.size(), sizeof(Agent)).
template <class T>
class StridedSpan {
    using Byte = std::conditional_t<std::is_const_v<T>, const std::byte, std::byte>;

  public:
    StridedSpan() = default;
    StridedSpan(T* first, std::size_t size, std::size_t stride_bytes = sizeof(T))
        : first_(reinterpret_cast<Byte*>(first)), size_(size), stride_(stride_bytes)
    {
    }
    /// Converts anything that is convertible to std::span<T>.
    template <class Container>
    requires std::is_convertible_v<Container&&, std::span<T>>
    // NOLINTNEXTLINE(google-explicit-constructor)
    StridedSpan(Container&& elements)
        : StridedSpan(std::span<T>(elements).data(), std::span<T>(elements).size())
    {
    }

    T& operator[](std::size_t i) const { return *reinterpret_cast<T*>(first_ + i * stride_); }
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] bool empty() const { return size_ == 0; }

  private:
    Byte* first_ = nullptr;
    std::size_t size_ = 0;
    std::size_t stride_ = sizeof(T);
};

}  // namespace motley
#pragma GCC visibility pop
