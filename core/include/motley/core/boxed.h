// A member whose type is known only to its owner's source files, so that changes of that type do not recompile every
// file that includes the owner's header.
#pragma once

#include <memory>
#include <utility>

#pragma GCC visibility push(default)
namespace motley {

/// Owns a T, and copies it when copied. After a move it may only be assigned to or destroyed. A header declares
/// `extern template class Boxed<T>;`, and one source file defines `template class Boxed<T>;`.
template <class T>
class Boxed {
  public:
    Boxed();
    Boxed(const Boxed& other);
    Boxed(Boxed&& other) noexcept;
    Boxed& operator=(const Boxed& other);
    Boxed& operator=(Boxed&& other) noexcept;
    ~Boxed();

    T& operator*() { return *value_; }
    const T& operator*() const { return *value_; }
    T* operator->() { return value_.get(); }
    const T* operator->() const { return value_.get(); }

  private:
    std::unique_ptr<T> value_;
};

template <class T>
Boxed<T>::Boxed() : value_(std::make_unique<T>())
{
}
template <class T>
Boxed<T>::Boxed(const Boxed& other) : value_(std::make_unique<T>(*other.value_))
{
}
template <class T>
Boxed<T>::Boxed(Boxed&& other) noexcept = default;
template <class T>
Boxed<T>& Boxed<T>::operator=(const Boxed& other)
{
    if (value_) {
        *value_ = *other.value_;
    } else {
        value_ = std::make_unique<T>(*other.value_);
    }
    return *this;
}
template <class T>
Boxed<T>& Boxed<T>::operator=(Boxed&& other) noexcept = default;
template <class T>
Boxed<T>::~Boxed() = default;

}  // namespace motley
#pragma GCC visibility pop
