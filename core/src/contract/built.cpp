// Checks joints, models and methods against those that were built; .cmake/built.cmake defines the macros.
#include "contract/built.h"

#include <string>

#include "motley/core/invalid_input.h"

#ifndef MOTLEY_BUILT_JOINTS
#define MOTLEY_BUILT_JOINTS "all"
#define MOTLEY_BUILT_MODELS "all"
#endif

namespace motley {

void refuse_unbuilt_joint(std::string_view definition)
{
    const std::string_view joints = MOTLEY_BUILT_JOINTS;
    refuse("joint", std::string(definition),
           "one that is built, MOTLEY_JOINTS: " + std::string(joints.empty() ? "none" : joints));
}

void check_model_is_built(const char* field, BodyModel model)
{
#ifdef MOTLEY_WITHOUT_PARTICLE
    if (model == BodyModel::particle)
        refuse(field, "particle", "one that is built, MOTLEY_MODELS: " MOTLEY_BUILT_MODELS);
#endif
#ifdef MOTLEY_WITHOUT_PLANAR
    if (model == BodyModel::planar)
        refuse(field, "planar", "one that is built, MOTLEY_MODELS: " MOTLEY_BUILT_MODELS);
#endif
#ifdef MOTLEY_WITHOUT_RIGID
    if (model == BodyModel::rigid)
        refuse(field, "rigid", "one that is built, MOTLEY_MODELS: " MOTLEY_BUILT_MODELS);
#endif
    static_cast<void>(field), static_cast<void>(model);
}

void check_method_is_built(Method method)
{
#ifdef MOTLEY_WITHOUT_DIRECT
    if (method == Method::direct)
        refuse("SolverSettings.method", "direct",
               "one that is built, MOTLEY_DIRECT=OFF: soft_step or sequential_impulse");
#endif
    static_cast<void>(method);
}

}  // namespace motley
