// The peers that may be built in; peers.cpp asks which ones were.
#pragma once

#include "engines/engine.h"

namespace motley::bench {

Peer bullet();
Peer ode();

}  // namespace motley::bench
