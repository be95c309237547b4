// See wkt.h.
#include "motley/wkt/wkt.h"

#include <geos_c.h>

#include <cctype>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "motley/core/invalid_input.h"
#include "wkt_text.h"

namespace motley {
namespace {

/// GEOS, and the last thing that it said.
class Geos {
  public:
    Geos() : handle_(GEOS_init_r())
    {
        const auto listen = [](const char* message, void* said) {
            *static_cast<std::string*>(said) = message;
        };
        GEOSContext_setErrorMessageHandler_r(handle_, listen, &said_);
    }
    ~Geos() { GEOS_finish_r(handle_); }
    Geos(const Geos&) = delete;
    Geos& operator=(const Geos&) = delete;

    [[nodiscard]] GEOSContextHandle_t handle() const { return handle_; }
    /// Without the name of the exception.
    [[nodiscard]] std::string said() const
    {
        const std::size_t colon = said_.find("Exception: ");
        std::string message = colon == std::string::npos ? said_ : said_.substr(colon + 11);
        while (!message.empty() && std::isspace(static_cast<unsigned char>(message.back())) != 0)
            message.pop_back();
        return message.empty() ? "GEOS failed" : message;
    }

  private:
    GEOSContextHandle_t handle_;
    std::string said_;
};

/// Owns what a function of GEOS returned.
template <auto destroy, class Object>
auto own(const Geos& geos, Object* object)
{
    const auto end = [handle = geos.handle()](Object* owned) { destroy(handle, owned); };
    return std::unique_ptr<Object, decltype(end)>(object, end);
}
auto own_geometry(const Geos& geos, GEOSGeometry* geometry)
{
    return own<GEOSGeom_destroy_r>(geos, geometry);
}

std::string text_of(const Geos& geos, char* text)
{
    std::string copy = text != nullptr ? text : "unknown";
    GEOSFree_r(geos.handle(), text);
    return copy;
}

std::string first_letter_small(std::string text)
{
    if (!text.empty()) text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
    return text;
}

class Reader {
  public:
    Reader(const Geos& geos, const WktOptions& options) : geos_(geos), options_(options) {}
    WktShapes shapes;

    /// Adds a geometry of the text, or the parts of a collection.
    void add(const GEOSGeometry* geometry)
    {
        switch (GEOSGeomTypeId_r(geos_.handle(), geometry)) {
            case GEOS_LINESTRING:
            case GEOS_LINEARRING:
            case GEOS_POLYGON:
            case GEOS_MULTIPOLYGON:
                add_one(geometry);
                return;
            case GEOS_MULTILINESTRING:
            case GEOS_GEOMETRYCOLLECTION:
                for_each_part(geometry, [&](const GEOSGeometry* part) { add(part); });
                return;
            default:
                ++number_;
                refuse_wkt("expected polygons, lines and collections of these" + name_of(geometry));
        }
    }

  private:
    const Geos& geos_;
    const WktOptions& options_;
    int number_ = 0;  ///< of the geometry at hand, from 1

    [[nodiscard]] std::string name_of(const GEOSGeometry* geometry) const
    {
        return ", in geometry " + std::to_string(number_) + ", a " +
               text_of(geos_, GEOSGeomType_r(geos_.handle(), geometry));
    }
    template <class Work>
    void for_each_part(const GEOSGeometry* geometry, const Work& work) const
    {
        const int parts = GEOSGetNumGeometries_r(geos_.handle(), geometry);
        for (int i = 0; i < parts; ++i) work(GEOSGetGeometryN_r(geos_.handle(), geometry, i));
    }

    void add_one(const GEOSGeometry* geometry)
    {
        ++number_;
        if (!options_.repair) {
            check(geometry);
            add_checked(geometry);
            return;
        }
        const auto ways =
            own<GEOSMakeValidParams_destroy_r>(geos_, GEOSMakeValidParams_create_r(geos_.handle()));
        GEOSMakeValidParams_setMethod_r(geos_.handle(), ways.get(), GEOS_MAKE_VALID_STRUCTURE);
        GEOSMakeValidParams_setKeepCollapsed_r(geos_.handle(), ways.get(), 0);
        const auto mended =
            own_geometry(geos_, GEOSMakeValidWithParams_r(geos_.handle(), geometry, ways.get()));
        if (!mended) refuse_wkt(first_letter_small(geos_.said()) + name_of(geometry));
        add_checked(mended.get());
    }

    /// Refuses what is not valid.
    void check(const GEOSGeometry* geometry) const
    {
        char* reason = nullptr;
        GEOSGeometry* location = nullptr;
        const char is_valid = GEOSisValidDetail_r(geos_.handle(), geometry, 0, &reason, &location);
        const auto place = own_geometry(geos_, location);
        if (is_valid == 1) {
            GEOSFree_r(geos_.handle(), reason);
            return;
        }
        std::string what = is_valid == 0 ? text_of(geos_, reason) : geos_.said();
        double x = 0, y = 0;
        if (place && GEOSGeomGetX_r(geos_.handle(), place.get(), &x) == 1 &&
            GEOSGeomGetY_r(geos_.handle(), place.get(), &y) == 1) {
            char at[64];
            std::snprintf(at, sizeof at, " at (%.9g %.9g)", x, y);
            what += at;
        }
        refuse_wkt(first_letter_small(what) + name_of(geometry));
    }

    /// Adds what is valid; mending may have left points, which are no shapes.
    void add_checked(const GEOSGeometry* geometry)
    {
        if (GEOSisEmpty_r(geos_.handle(), geometry) != 0) return;
        switch (GEOSGeomTypeId_r(geos_.handle(), geometry)) {
            case GEOS_LINESTRING:
            case GEOS_LINEARRING:
                shapes.lines.push_back(points_of(geometry));
                return;
            case GEOS_POLYGON:
                shapes.polygons.push_back(polygon_of(geometry));
                return;
            case GEOS_POINT:
            case GEOS_MULTIPOINT:
                return;
            default:
                for_each_part(geometry, [&](const GEOSGeometry* part) { add_checked(part); });
        }
    }

    [[nodiscard]] Polygon polygon_of(const GEOSGeometry* geometry) const
    {
        Polygon polygon;
        polygon.outer = ring_of(GEOSGetExteriorRing_r(geos_.handle(), geometry));
        const int holes = GEOSGetNumInteriorRings_r(geos_.handle(), geometry);
        for (int i = 0; i < holes; ++i) {
            const GEOSGeometry* hole = GEOSGetInteriorRingN_r(geos_.handle(), geometry, i);
            if (GEOSisEmpty_r(geos_.handle(), hole) == 0) polygon.holes.push_back(ring_of(hole));
        }
        return polygon;
    }

    /// Without the last point, which is the first.
    [[nodiscard]] std::vector<Vec2<double>> ring_of(const GEOSGeometry* geometry) const
    {
        std::vector<Vec2<double>> ring = points_of(geometry);
        if (!ring.empty()) ring.pop_back();
        return ring;
    }

    /// Without points in the place of the point before.
    [[nodiscard]] std::vector<Vec2<double>> points_of(const GEOSGeometry* geometry) const
    {
        const GEOSCoordSequence* sequence = GEOSGeom_getCoordSeq_r(geos_.handle(), geometry);
        unsigned count = 0;
        GEOSCoordSeq_getSize_r(geos_.handle(), sequence, &count);
        std::vector<Vec2<double>> points;
        for (unsigned i = 0; i < count; ++i) {
            Vec2<double> point;
            GEOSCoordSeq_getXY_r(geos_.handle(), sequence, i, &point.x, &point.y);
            if (points.empty() || point.x != points.back().x || point.y != points.back().y)
                points.push_back(point);
        }
        return points;
    }
};

}  // namespace

WktShapes read_wkt(std::string_view text, const WktOptions& options)
{
    check_wkt_text(text);
    const Geos geos;
    const auto parser = own<GEOSWKTReader_destroy_r>(geos, GEOSWKTReader_create_r(geos.handle()));
    GEOSWKTReader_setFixStructure_r(geos.handle(), parser.get(), options.repair ? 1 : 0);
    const auto geometry =
        own_geometry(geos, GEOSWKTReader_read_r(geos.handle(), parser.get(), std::string(text).c_str()));
    if (!geometry) {
        const std::string open_ring = find_open_ring(text);
        const bool is_open = geos.said().find("closed linestring") != std::string::npos;
        refuse_wkt(is_open && !open_ring.empty() ? open_ring + " is not closed"
                                                 : first_letter_small(geos.said()));
    }
    Reader reader(geos, options);
    reader.add(geometry.get());
    return std::move(reader.shapes);
}

}  // namespace motley
