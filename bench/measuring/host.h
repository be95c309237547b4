// What the machine reports about itself while it is measured.
#pragma once

namespace motley::bench {

/// The load of the machine over the last minute, as the system tells it; negative if it does not.
double host_load();
/// Bytes of this process in memory; 0 if the system does not tell.
double resident_bytes();
/// Bytes that the program has allocated and not freed.
double allocated_bytes();

}  // namespace motley::bench
