// Another project that reads a figure.
#include <motley/mjcf/mjcf.h>
#include <motley/motley.h>

int main()
{
    const motley::MjcfModel model = motley::read_mjcf(
        "<mujoco><worldbody><body><joint type='ball'/><geom pos='1 0 0' "
        "size='.1'/></body></worldbody></mujoco>");
    motley::Scene scene;
    const motley::Placing origin;
    return motley::add_assembly(scene, model.figures.at(0).figure, {&origin, 1}).size() == 2 ? 0 : 1;
}
