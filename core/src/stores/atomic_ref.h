#pragma once

namespace motley {

/// What the library needs of std::atomic_ref, which libc++ has only since version 19: relaxed atomic access to an ordinary
/// integer. All threads that share the integer at that time must go through one of these.
template <class T>
class AtomicRef {
  public:
    explicit AtomicRef(T& value) : value_(&value) {}

    [[nodiscard]] T load() const { return __atomic_load_n(value_, __ATOMIC_RELAXED); }
    void store(T value) const { __atomic_store_n(value_, value, __ATOMIC_RELAXED); }
    /// Stores `value` and returns what was there.
    [[nodiscard]] T exchange(T value) const { return __atomic_exchange_n(value_, value, __ATOMIC_RELAXED); }
    /// Sets the bits that `bits` has.
    void set_bits(T bits) const { __atomic_fetch_or(value_, bits, __ATOMIC_RELAXED); }
    /// Stores `value` if `expected` is there, and returns whether it was; otherwise puts what is there into `expected`.
    [[nodiscard]] bool compare_exchange(T& expected, T value) const
    {
        return __atomic_compare_exchange_n(value_, &expected, value, false, __ATOMIC_RELAXED,
                                           __ATOMIC_RELAXED);
    }

  private:
    T* value_;
};

}  // namespace motley
