// Figures of the C interface as a whole. What is added to them stands beside what is added to scenes.
#include "motley/c/figures.h"

#include <algorithm>

#include "handles.h"
#include "motley/core/assembly.h"

namespace motley::c {

template <>
struct Mirror<motley_placing, Placing> : Pair<motley_placing, Placing> {
    static constexpr const char* name = "motley_placing";
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(position), MOTLEY_FIELD(orientation), MOTLEY_FIELD(linear_velocity));
};

}  // namespace motley::c

using namespace motley;
using namespace motley::c;

MOTLEY_DEFINE_DEFAULT(placing, Placing)

motley_status motley_figure_create(motley_figure** figure)
{
    return call(__func__, [&] {
        motley_figure*& handle = need(figure, "figure");
        handle = new motley_figure{};
    });
}

void motley_figure_destroy(motley_figure* figure)
{
    delete figure;
}

motley_status motley_figure_body_count(const motley_figure* figure, size_t* count)
{
    return call(__func__, [&] { need(count, "count") = figure_of(figure).bodies().size(); });
}

motley_status motley_figure_joint_count(const motley_figure* figure, size_t* count)
{
    return call(__func__, [&] { need(count, "count") = figure_of(figure).joint_count(); });
}

motley_status motley_scene_add_assembly(motley_scene* scene, const motley_figure* figure, size_t count,
                                        const motley_placing* copies, size_t stride, motley_body_id* bodies)
{
    return call(__func__, [&] {
        Scene& to = scene_of(scene);
        const Figure& of = figure_of(figure);
        const auto placings = read_all<Placing>(copies, count, stride, "copies");
        const auto ids = array<BodyId>(bodies, count * of.bodies().size(), "bodies");
        const std::vector<BodyId> added = add_assembly(to, of, placings);
        std::copy(added.begin(), added.end(), ids.begin());
    });
}
