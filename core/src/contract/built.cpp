// Checks joints, models and methods against those that were built; .cmake/built.cmake defines the macros.
#include "contract/built.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <type_traits>

#include "contract/constraint_types.h"
#include "motley/core/invalid_input.h"

namespace motley {
namespace {

#ifdef MOTLEY_BUILT_TYPES
using BuiltTypes = Joined<MOTLEY_BUILT_TYPES>;
#else
using BuiltTypes = Joined<ContactTypes, JointTypes>;
#define MOTLEY_BUILT_JOINTS "all"
#define MOTLEY_BUILT_MODELS "all"
#endif

template <class Type, class... Built>
constexpr bool is_one_of(TypeList<Built...>)
{
    return (std::is_same_v<Type, Built> || ...);
}

/// The name of a definition as the compiler spells it.
template <class Definition>
std::string name_of()
{
    const std::string_view function = __PRETTY_FUNCTION__;
    const std::size_t begin = function.find("Definition = ") + 13;
    return std::string(function.substr(begin, function.find_first_of(";]", begin) - begin));
}

template <class... Types>
void check(int type, TypeList<Types...>)
{
    const bool built[] = {is_one_of<Types>(BuiltTypes{})...};
    if (built[type]) return;
    std::string (*const names[])() = {name_of<typename Types::Definition>...};
    const std::string_view joints = MOTLEY_BUILT_JOINTS;
    refuse("joint", names[type](),
           "one that is built, MOTLEY_JOINTS: " + std::string(joints.empty() ? "none" : joints));
}

}  // namespace

void check_joint_is_built(int type)
{
    check(type, JointTypes{});
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
