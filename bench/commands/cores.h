// Measures what the machine gives to threads at the moment. Two threads of a virtual machine may for a while share
// one core, or run on cores that share no cache; and clock rates vary.
#pragma once

#include "motley/motley.h"

namespace motley::bench {

struct CoresAtHand {
    double cores = 0;  ///< how much more arithmetic all threads do together than one alone
    double hand_over_seconds =
        0;  ///< from the first thread to the second through a cache line; infinite where no second came
};

/// Measures the executor's threads, of which there must be at least two. Takes about a millisecond.
CoresAtHand look_at_cores(Executor& executor);

}  // namespace motley::bench
