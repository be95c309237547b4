#include "engines/peers.h"

namespace motley::bench {

std::vector<Peer> peers()
{
    std::vector<Peer> found;
#ifdef MOTLEY_HAS_BULLET
    found.push_back(bullet());
#endif
#ifdef MOTLEY_HAS_ODE
    found.push_back(ode());
#endif
    return found;
}

std::vector<std::string> missing_peers()
{
    std::vector<std::string> missing;
#ifndef MOTLEY_HAS_BULLET
    missing.emplace_back("Bullet was not found when the program was built: libbullet-dev");
#endif
#ifndef MOTLEY_HAS_ODE
    missing.emplace_back("ODE was not found when the program was built: libode-dev");
#endif
    return missing;
}

}  // namespace motley::bench
