// Scene: people as discs, walls, and what they bear; and queries.
#include <cmath>

#include "arrays.h"
#include "scene.h"
#ifdef MOTLEY_WITH_WKT
#include "motley/wkt/wkt.h"
#endif

namespace motley::python {
namespace {

/// Planar bodies with discs, all or none.
py::array_t<std::uint64_t> add_people(PythonScene& scene, const py::object& positions,
                                      const py::object& radius, const py::object& mass,
                                      const py::object& friction)
{
    const std::vector<Vec2<double>> places = points_from("positions", positions);
    const std::vector<float> radii = for_each_of<float>("radius", radius, places.size()),
                             masses = for_each_of<float>("mass", mass, places.size()),
                             frictions = for_each_of<float>("friction", friction, places.size());
    std::vector<BodyDefinition> bodies(places.size());
    std::vector<DiscDefinition> discs(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        bodies[i].model = BodyModel::planar;
        bodies[i].position = {places[i].x, places[i].y, 0};
        bodies[i].mass = masses[i];
        bodies[i].inertia.zz = masses[i] * radii[i] * radii[i] / 2;
        discs[i].radius = radii[i];
        discs[i].friction = frictions[i];
    }
    std::vector<BodyId> ids(bodies.size());
    scene.get().add_bodies(bodies, ids);
    try {
        scene.get().set_discs(ids, discs);
    } catch (...) {
        scene.get().remove_bodies(ids);
        throw;
    }
    return handles_of<BodyId>(ids);
}

WallDefinition wall_from(const py::kwargs& fields)
{
    WallDefinition wall;
    Keywords given("WallDefinition", fields);
    given.take("closed", wall.closed);
    given.take("body", wall.body);
    given.take("friction", wall.friction);
    given.take("category", wall.category);
    given.take("mask", wall.mask);
    given.take("one_way", wall.one_way);
    given.take("surface_speed", wall.surface_speed);
    given.take("max_force", wall.max_force);
    given.end();
    return wall;
}

std::uint64_t add_wall(PythonScene& scene, const py::object& points, const py::kwargs& fields)
{
    WallDefinition wall = wall_from(fields);
    const std::vector<Vec2<double>> chain = points_from("points", points);
    wall.points = chain;
    return number_of(scene.get().add_wall(wall));
}

Polygon polygon_from(const py::object& outer, const py::object& holes)
{
    Polygon polygon{points_from("outer", outer), {}};
    if (!py::isinstance<py::iterable>(holes)) refuse_value("holes", holes, "rings of points");
    for (const py::handle ring : holes) polygon.holes.push_back(points_from("holes", ring));
    return polygon;
}

py::array_t<std::uint64_t> add_rings(PythonScene& scene, const py::object& outer, const py::object& holes,
                                     const py::kwargs& fields)
{
    const WallDefinition like = wall_from(fields);
    return handles_of<WallId>(add_polygon(scene.get(), polygon_from(outer, holes), like));
}

py::array_t<std::uint64_t> add_wkt(PythonScene& scene, const std::string& text, bool repair,
                                   const py::kwargs& fields)
{
#ifdef MOTLEY_WITH_WKT
    WallDefinition like = wall_from(fields);
    const WktShapes shapes = read_wkt(text, {.repair = repair});
    std::vector<WallId> walls;
    try {
        for (const Polygon& polygon : shapes.polygons) {
            for (const WallId wall : add_polygon(scene.get(), polygon, like)) walls.push_back(wall);
        }
        for (const std::vector<Vec2<double>>& line : shapes.lines) {
            like.points = line;
            walls.push_back(scene.get().add_wall(like));
        }
    } catch (...) {
        for (const WallId wall : walls) scene.get().remove_wall(wall);
        throw;
    }
    return handles_of<WallId>(walls);
#else
    static_cast<void>(scene);
    static_cast<void>(text);
    static_cast<void>(repair);
    static_cast<void>(fields);
    throw std::runtime_error("motley was built without GEOS, which reads WKT (MOTLEY_WKT)");
#endif
}

/// With the circumference of each disc where none is given.
py::dict read_loads(PythonScene& scene, const py::object& bodies, const py::object& circumferences)
{
    const Handles ids("bodies", bodies);
    std::vector<BodyLoad> loads(ids.size());
    if (circumferences.is_none()) {
        scene.get().read_loads(ids.span<BodyId>(), {}, StridedSpan<BodyLoad>(loads));
    } else {
        const std::vector<float> around = for_each_of<float>("circumferences", circumferences, ids.size());
        scene.get().read_loads(ids.span<BodyId>(), {}, StridedSpan<BodyLoad>(loads),
                               StridedSpan<const float>(around));
    }
    py::dict all;
    all["normal_force"] = column(loads, &BodyLoad::normal_force);
    all["largest_normal_force"] = column(loads, &BodyLoad::largest_normal_force);
    all["net_force"] = column(loads, &BodyLoad::net_force);
    all["pressure"] = column(loads, &BodyLoad::pressure);
    return all;
}

py::dict disc_contacts(PythonScene& scene)
{
    const std::vector<DiscContact> contacts = scene.get().disc_contacts();
    py::dict all;
    all["a"] = column(contacts, &DiscContact::a);
    all["b"] = column(contacts, &DiscContact::b);
    all["wall"] = column(contacts, &DiscContact::wall);
    all["normal"] = column(contacts, &DiscContact::normal);
    all["separation"] = column(contacts, &DiscContact::separation);
    all["normal_force"] = column(contacts, &DiscContact::normal_force);
    all["friction_force"] = column(contacts, &DiscContact::friction_force);
    return all;
}

}  // namespace

void add_crowds_to(SceneClass& scene)
{
    scene.def("add_people", &add_people, py::arg("positions"), py::arg("radius") = 0.2,
              py::arg("mass") = 80.0, py::arg("friction") = 0.0,
              "Adds a person at each of positions (n x 2, m): planar bodies with discs, whose contacts every "
              "step finds. radius\n"
              "(m), mass (kg) and the coefficient of friction are of all or of each. Returns handles, an "
              "array of uint64.");
    scene.def(
        "set_disc",
        [](PythonScene& self, std::uint64_t body, const py::kwargs& fields) {
            DiscDefinition disc;
            Keywords given("DiscDefinition", fields);
            given.take("radius", disc.radius);
            given.take("friction", disc.friction);
            given.take("category", disc.category);
            given.take("mask", disc.mask);
            given.end();
            self.get().set_disc(id_of<BodyId>(body), disc);
        },
        py::arg("body"),
        "Makes a planar body a disc, or another one than it is. Fields of DiscDefinition: radius (m), "
        "friction, category,\n"
        "mask.");
    scene.def(
        "clear_disc",
        [](PythonScene& self, std::uint64_t body) { self.get().clear_disc(id_of<BodyId>(body)); },
        py::arg("body"),
        "Takes the disc of a body away, as before change_body to a model that is not planar.");
    scene.def("add_wall", &add_wall, py::arg("points"),
              "Adds a wall along points (n x 2, m). Fields of WallDefinition: closed, body, friction, "
              "category, mask, one_way,\n"
              "surface_speed (m/s) and max_force (N). Returns its handle.");
    scene.def("_add_rings", &add_rings, py::arg("outer"), py::arg("holes"));
    scene.def("_add_wkt", &add_wkt, py::arg("text"), py::arg("repair"));
    scene.def(
        "remove_wall",
        [](PythonScene& self, std::uint64_t wall) { self.get().remove_wall(id_of<WallId>(wall)); },
        py::arg("wall"), "Removes a wall.");
    scene.def("read_loads", &read_loads, py::arg("bodies"), py::arg("circumferences") = py::none(),
              "What contacts of discs and capsules put on bodies, mean over the last step, as arrays of "
              "float32: normal_force\n"
              "(N, their sum), largest_normal_force (N), net_force (n x 3, N) and, where circumferences (m) "
              "are given,\n"
              "pressure (N/m).");
    scene.def("disc_contacts", &disc_contacts,
              "The contacts of discs that pushed in the last step, as arrays: a and b (handles), wall (0: "
              "none), normal (from a\n"
              "to b), separation (m), normal_force and friction_force (N, on b).");
}

void add_queries_to(py::module_& module)
{
    py::class_<CrowdIndex>(
        module, "CrowdIndex",
        "Who is near a point or in an area, as it was when the index was built: CrowdIndex(scene).")
        .def(py::init([](PythonScene& scene) {
                 CrowdIndex index;
                 index.build(scene.get());
                 return index;
             }),
             py::arg("scene"))
        .def("__len__", &CrowdIndex::size)
        .def(
            "within",
            [](const CrowdIndex& self, const py::object& point, double radius) {
                std::vector<BodyId> found;
                self.centres_within(value_of<Vec2<double>>("point", point), radius, found);
                return handles_of<BodyId>(found);
            },
            py::arg("point"), py::arg("radius"), "Those whose centres are at most radius (m) away.")
        .def(
            "nearest",
            [](const CrowdIndex& self, const py::object& point, std::size_t count) {
                std::vector<NearPerson> found;
                self.nearest(value_of<Vec2<double>>("point", point), count, found);
                std::vector<BodyId> ids;
                py::array_t<double> distances(static_cast<py::ssize_t>(found.size()));
                for (std::size_t i = 0; i < found.size(); ++i) {
                    ids.push_back(found[i].body);
                    distances.mutable_data()[i] = found[i].distance;
                }
                return py::make_tuple(handles_of<BodyId>(ids), distances);
            },
            py::arg("point"), py::arg("count") = 1,
            "The handles of the nearest people, and their distances (m).")
        .def(
            "_inside",
            [](const CrowdIndex& self, const py::object& outer, const py::object& holes) {
                std::vector<BodyId> found;
                self.inside(polygon_from(outer, holes), found);
                return handles_of<BodyId>(found);
            },
            py::arg("outer"), py::arg("holes"));
    py::class_<WallIndex>(module, "WallIndex",
                          "What walls hide, as it was when the index was built: WallIndex(scene).")
        .def(py::init([](PythonScene& scene) {
                 WallIndex index;
                 index.build(scene.get());
                 return index;
             }),
             py::arg("scene"))
        .def(
            "is_free",
            [](const WallIndex& self, const py::object& from, const py::object& to) {
                return self.is_free(value_of<Vec2<double>>("start", from), value_of<Vec2<double>>("end", to));
            },
            py::arg("start"), py::arg("end"), "Whether no wall is on the straight way from start to end.");
}

}  // namespace motley::python
