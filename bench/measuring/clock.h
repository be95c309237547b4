// The clock of every measurement here. It is steady: changes of the time of day do not affect it.
#pragma once

#include <chrono>

namespace motley::bench {

/// Seconds since some moment in the past.
inline double now()
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace motley::bench
