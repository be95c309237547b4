// What the machine gives to threads at the moment. Two threads of a virtual machine may be of one core for a while, or of cores
// that share no cache; a clock wanders besides.
#pragma once

#include "motley/motley.h"

namespace motley::bench {

struct CoresAtHand {
    double cores = 0;  ///< how much more arithmetic all threads do together than one alone
    double hand_over_seconds =
        0;  ///< from the first thread to the second through a cache line; infinite where no second came
};

/// Of the executor's threads, of which there are at least two. Takes about a millisecond.
CoresAtHand look_at_cores(Executor& executor);

}  // namespace motley::bench
