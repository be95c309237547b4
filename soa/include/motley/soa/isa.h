// The instruction sets that the kernels are compiled for, and which of them this machine has.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#pragma GCC visibility push(default)
namespace motley {

/// One build of the kernels. Every one of them computes the same bits.
enum class Isa { scalar, sse2, avx2, avx512, neon };

/// "scalar", "sse2", "avx2", "avx512", "neon".
std::string_view isa_name(Isa isa);
/// The inverse of isa_name; empty for an unknown name.
std::optional<Isa> isa_from_name(std::string_view name);
/// Lanes that the instruction set computes at once.
int isa_width(Isa isa);
/// The instruction sets compiled in that this processor and operating system can run, narrowest first.
std::vector<Isa> available_isas();
/// The one named by the environment variable MOTLEY_ISA, else the widest available.
/// Throws InvalidInput if MOTLEY_ISA names one that is unknown or not available here.
Isa default_isa();

}  // namespace motley
#pragma GCC visibility pop
