// The peers that may be built in; peers.cpp asks which are.
#pragma once

#include "engine.h"

namespace motley::bench {

Peer bullet();
Peer ode();

}  // namespace motley::bench
