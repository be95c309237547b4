// Names of the stages.
#include "motley/core/step_report.h"

namespace motley {

const char* stage_name(Stage stage)
{
    static constexpr const char* names[stage_count] = {"intake",
                                                       "colour",
                                                       "prepare",
                                                       "figures",
                                                       "integrate velocities",
                                                       "warm start",
                                                       "solve",
                                                       "integrate positions",
                                                       "relax",
                                                       "restitution",
                                                       "store"};
    return names[static_cast<int>(stage)];
}

}  // namespace motley
