// Floor plans as text: polygons and lines in WKT (OGC 06-103r4, Simple Feature Access), as JuPedSim and Shapely write it.
// A library of its own, motley::wkt, because it links GEOS.
#pragma once

#include <string_view>
#include <vector>

#include "motley/core/polygon.h"
#include "motley/core/vector.h"

#pragma GCC visibility push(default)
namespace motley {

/// What a text holds, in its order: the first polygon is polygons[0]. Coordinates are x and y as written; heights and
/// measures are left out.
struct WktShapes {
    /// For add_polygon(), and for queries. Points of a ring that are in the same place as the point before are left out.
    std::vector<Polygon> polygons;
    /// For Scene::add_wall, two points or more each; the same holds. A closed line ends in its first point.
    std::vector<std::vector<Vec2<double>>> lines;
};

/// How read_wkt() takes what it reads.
struct WktOptions {
    /// Whether polygons that are not valid are mended, instead of refused: rings are closed, those that cross themselves
    /// are cut up, holes are cut out, parts that overlap are united (GEOSMakeValid by structure). One polygon may become
    /// several, or none.
    bool repair = false;
};

/// Reads POLYGON, MULTIPOLYGON, LINESTRING, LINEARRING, MULTILINESTRING and GEOMETRYCOLLECTION, with Z or M, or EMPTY.
/// Throws InvalidInput for everything else, and for polygons that are not valid as OGC defines it. The message says what
/// is wrong and where, by the coordinates, by the character from 1, or by the geometry from 1:
/// "WKT: self-intersection at (1 2), in geometry 3, a Polygon". May be called on several threads at once; GEOS sets the
/// numeric locale of the process to "C" while it reads.
WktShapes read_wkt(std::string_view text, const WktOptions& options = {});

}  // namespace motley
#pragma GCC visibility pop
