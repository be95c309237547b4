// The floating-point environment of a step: it rounds to nearest and takes denormals for zero, whatever the host has
// set. So the bits do not depend on the host's rounding, and bodies that slow down towards rest do not cost the
// hundred cycles or so that a processor takes for every denormal.
#pragma once

#include <cstdint>

namespace motley {

/// Sets the environment of a step on this thread, and restores the host's when it is destroyed. Exceptions stay
/// masked or unmasked as the host has them, and flags that were raised in between stay raised.
class StepFloats {
  public:
    StepFloats() : host_(control()) { set_control((host_ & ~rounding) | flushes_denormals); }
    ~StepFloats() { set_control(host_ | (control() & raised)); }
    StepFloats(const StepFloats&) = delete;
    StepFloats& operator=(const StepFloats&) = delete;

  private:
#if defined(__x86_64__)
    // MXCSR, Intel 64 and IA-32 Architectures Software Developer's Manual, volume 1, figure 10-3.
    using Word = std::uint32_t;
    static constexpr Word raised = 0x3f, denormals_are_zero = 1U << 6, rounding = 3U << 13,
                          flush_to_zero = 1U << 15;
    static constexpr Word flushes_denormals = denormals_are_zero | flush_to_zero;
    static Word control()
    {
        return __builtin_ia32_stmxcsr();
    }
    static void set_control(Word word)
    {
        __builtin_ia32_ldmxcsr(word);
    }
#elif defined(__aarch64__)
    // FPCR, Arm Architecture Reference Manual for A-profile: the flags of raised exceptions are in another register.
    using Word = std::uint64_t;
    static constexpr Word raised = 0, rounding = 3U << 22, flushes_denormals = 1U << 24;
    static Word control()
    {
        Word word = 0;
        asm volatile("mrs %0, fpcr" : "=r"(word));
        return word;
    }
    static void set_control(Word word)
    {
        asm volatile("msr fpcr, %0" ::"r"(word));
    }
#else
    using Word = std::uint32_t;
    static constexpr Word raised = 0, rounding = 0, flushes_denormals = 0;
    static Word control()
    {
        return 0;
    }
    static void set_control(Word) {}
#endif
    Word host_;
};

}  // namespace motley
