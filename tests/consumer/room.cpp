// Another project that reads a floor plan.
#include <motley/motley.h>
#include <motley/wkt/wkt.h>

int main()
{
    const motley::WktShapes plan = motley::read_wkt("POLYGON ((0 0, 4 0, 4 4, 0 0))");
    motley::Scene scene;
    return motley::add_polygon(scene, plan.polygons.at(0)).size() == 1 ? 0 : 1;
}
