// Which kernels were compiled, and which of them this machine can run.
#include "motley/soa/isa.h"

#include <cstdlib>
#include <string>

#include "kernels/kernel_entries.h"
#include "kernels/kernel_table.h"
#include "motley/core/invalid_input.h"

namespace motley {

namespace {

struct IsaEntry {
    Isa isa;
    std::string_view name;
    int width;
};
constexpr IsaEntry entries[] = {{Isa::scalar, "scalar", 1},
                                {Isa::sse2, "sse2", 4},
                                {Isa::avx2, "avx2", 8},
                                {Isa::avx512, "avx512", 16},
                                {Isa::neon, "neon", 4}};

/// The builtin asks the processor and the operating system, for every feature that the kernels are compiled with.
bool is_available(Isa isa)
{
    switch (isa) {
        case Isa::scalar:
            return true;
#ifdef MOTLEY_SSE2
        case Isa::sse2:
            return true;
#endif
#ifdef MOTLEY_AVX2
        case Isa::avx2:
            return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#endif
#ifdef MOTLEY_AVX512
        case Isa::avx512:
            return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                   __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
                   __builtin_cpu_supports("avx512cd");
#endif
#ifdef MOTLEY_NEON
        case Isa::neon:
            return true;
#endif
        default:
            return false;
    }
}

}  // namespace

std::string_view isa_name(Isa isa)
{
    for (const IsaEntry& entry : entries) {
        if (entry.isa == isa) return entry.name;
    }
    return "unknown";
}

std::optional<Isa> isa_from_name(std::string_view name)
{
    for (const IsaEntry& entry : entries) {
        if (entry.name == name) return entry.isa;
    }
    return std::nullopt;
}

int isa_width(Isa isa)
{
    for (const IsaEntry& entry : entries) {
        if (entry.isa == isa) return entry.width;
    }
    return 0;
}

std::vector<Isa> available_isas()
{
    std::vector<Isa> isas;
    for (const IsaEntry& entry : entries) {
        if (is_available(entry.isa)) isas.push_back(entry.isa);
    }
    return isas;
}

Isa default_isa()
{
    const char* forced = std::getenv("MOTLEY_ISA");
    if (forced == nullptr || *forced == '\0') return available_isas().back();
    const std::optional<Isa> isa = isa_from_name(forced);
    if (isa && is_available(*isa)) return *isa;
    std::string names;
    for (const Isa available : available_isas())
        names.append(names.empty() ? "" : ", ").append(isa_name(available));
    refuse("MOTLEY_ISA", forced, "one of " + names + " on this machine");
}

namespace {

/// The instruction set whose kernels run what is rare or unusual: SSE2 and AVX-512 have no such kernels of their own,
/// which would be a quarter of the library. The bits do not depend on it.
constexpr Isa rare_lanes_of(Isa isa)
{
    switch (isa) {
        case Isa::sse2:
            return Isa::scalar;
        case Isa::avx512:
            return Isa::avx2;
        default:
            return isa;
    }
}

/// The instruction set that begins and ends a step. For joints AVX-512 would be no faster than AVX2, because the time is that of
/// reaching scattered memory; steps of listed contacts would take 0.96 of the time, for 79 kB.
constexpr Isa once_lanes_of(Isa isa)
{
    return isa == Isa::avx512 ? Isa::avx2 : isa;
}

/// The instruction set that solves contacts of discs. Two halves of a block in lanes of AVX2 overlap where one whole
/// block waits for itself: 0.8 times the time of AVX-512 on Zen 5.
constexpr Isa disc_lanes_of(Isa isa)
{
    return isa == Isa::avx512 ? Isa::avx2 : isa;
}

template <Isa isa, class... Lists>
void enter_constraints(KernelTable& table, TypeList<Lists...>)
{
    ConstraintKernels* next = table.constraints;
    const auto enter = [&]<class Types>(Types) {
        enter_constraint_kernels<isa, KernelShare::swept, Types>(next);
        enter_constraint_kernels<once_lanes_of(isa), KernelShare::once, Types>(next);
        enter_constraint_kernels<rare_lanes_of(isa), KernelShare::unusual, Types>(next);
        enter_constraint_kernels<rare_lanes_of(isa), KernelShare::rare, Types>(next);
        next += class_of(Types::size, BodyKind{}, BodyKind{});
    };
    (enter(Lists{}), ...);
}

/// Made on first use. Classes that a wide instruction set leaves out run in scalar lanes.
template <Isa isa>
const KernelTable& table_of()
{
    static const KernelTable table = [] {
        KernelTable entered;
        if constexpr (isa != Isa::scalar) entered = table_of<Isa::scalar>();
        entered.width = isa_width(isa);
        enter_constraints<isa>(entered, ConstraintLists{});
        enter_body_kernels<isa>(entered.bodies, entered.figures);
#ifndef MOTLEY_WITHOUT_PLANAR
        enter_disc_kernels<disc_lanes_of(isa)>(entered.discs);
#endif
#ifndef MOTLEY_WITHOUT_TREES
        enter_tree_kernels<isa>(entered.figures);
#endif
        return entered;
    }();
    return table;
}

}  // namespace

const KernelTable& kernel_table(Isa isa)
{
    switch (isa) {
#ifdef MOTLEY_SSE2
        case Isa::sse2:
            return table_of<Isa::sse2>();
#endif
#ifdef MOTLEY_AVX2
        case Isa::avx2:
            return table_of<Isa::avx2>();
#endif
#ifdef MOTLEY_AVX512
        case Isa::avx512:
            return table_of<Isa::avx512>();
#endif
#ifdef MOTLEY_NEON
        case Isa::neon:
            return table_of<Isa::neon>();
#endif
        default:
            return table_of<Isa::scalar>();
    }
}

}  // namespace motley
