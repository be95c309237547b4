// Scene: capsules, spheres and half-spaces, and their contacts.
#include "arrays.h"
#include "scene.h"

namespace motley::python {

CapsuleDefinition capsule_from(std::uint64_t body, const py::object& start, const py::object& end,
                               const py::kwargs& fields)
{
    CapsuleDefinition capsule;
    capsule.body = id_of<BodyId>(body);
    set("start", start, capsule.from);
    set("end", end, capsule.to);
    Keywords given("CapsuleDefinition", fields);
    given.take("radius", capsule.radius);
    given.take("friction", capsule.friction);
    given.take("restitution", capsule.restitution);
    given.take("category", capsule.category);
    given.take("mask", capsule.mask);
    given.take("group", capsule.group);
    given.end();
    return capsule;
}

namespace {

std::uint64_t add_half_space(PythonScene& scene, const py::kwargs& fields)
{
    HalfSpaceDefinition half_space;
    Keywords given("HalfSpaceDefinition", fields);
    given.take("body", half_space.body);
    given.take("point", half_space.point);
    given.take("normal", half_space.normal);
    given.take("friction", half_space.friction);
    given.take("restitution", half_space.restitution);
    given.take("category", half_space.category);
    given.take("mask", half_space.mask);
    given.end();
    return number_of(scene.get().add_half_space(half_space));
}

py::dict shape_contacts(PythonScene& scene)
{
    const std::vector<ShapeContact> contacts = scene.get().shape_contacts();
    py::dict all;
    all["a"] = column(contacts, &ShapeContact::a);
    all["b"] = column(contacts, &ShapeContact::b);
    all["wall"] = column(contacts, &ShapeContact::wall);
    all["normal"] = column(contacts, &ShapeContact::normal);
    all["arm_b"] = column(contacts, &ShapeContact::arm_b);
    all["separation"] = column(contacts, &ShapeContact::separation);
    all["normal_force"] = column(contacts, &ShapeContact::normal_force);
    all["friction_force"] = column(contacts, &ShapeContact::friction_force);
    return all;
}

}  // namespace

void add_shapes_to(SceneClass& scene)
{
    scene.def(
        "add_capsule",
        [](PythonScene& self, std::uint64_t body, const py::object& start, const py::object& end,
           const py::kwargs& fields) {
            return number_of(self.get().add_capsule(capsule_from(body, start, end, fields)));
        },
        py::arg("body"), py::arg("start"), py::arg("end"),
        "Gives a body a capsule around the line from start to end (m, in the body's frame), or a sphere "
        "where they are\n"
        "equal. Fields of CapsuleDefinition: radius (m), friction, restitution, category, mask, group. "
        "Returns its handle.");
    scene.def("add_half_space", &add_half_space,
              "Adds a half-space, such as a floor. Fields of HalfSpaceDefinition: body, point (m), normal, "
              "friction,\n"
              "restitution, category, mask. Returns its handle.");
    scene.def(
        "remove_shape",
        [](PythonScene& self, std::uint64_t shape) { self.get().remove_shape(id_of<ShapeId>(shape)); },
        py::arg("shape"), "Removes a capsule or a half-space.");
    scene.def("shape_contacts", &shape_contacts,
              "The contacts of capsules that the last step found, as arrays: a, b (handles), wall, normal, "
              "arm_b (m, from\n"
              "the centre of mass of b), separation (m), normal_force and friction_force (N, on b).");
}

}  // namespace motley::python
