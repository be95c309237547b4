// A member whose type only its owner's source files know, so that whoever includes the owner's header is not compiled anew with it.
#pragma once

#include <memory>
#include <utility>

namespace motley {

/// Holds a T of its own and copies with it. What was moved from may be assigned to and destroyed. A header says
/// `extern template class Boxed<T>;`, one source file `template class Boxed<T>;`.
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
