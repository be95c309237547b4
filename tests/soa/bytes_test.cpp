// The README's bytes a lane are what the kernels stream.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <string>

#include "block.h"

namespace motley {
namespace {

int bytes(const KernelTable& table, int type, BodyKind kind)
{
    const ConstraintKernels& kernels = table.constraints[class_of(type, kind, kind)];
    const int row = kernels.substep_floats > 0 ? kernels.substep_floats : kernels.row_floats;
    return 4 * (row + kernels.impulse_floats + 2);  // two body indices
}

TEST(Readme, BytesALaneAreWhatTheKernelsStream)
{
    std::ifstream file(MOTLEY_README);
    ASSERT_TRUE(file) << MOTLEY_README;
    std::map<std::string, std::string> last_cells;  // of the table's rows, by the first cell's beginning
    bool in_section = false;
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("## ")) in_section = line == "## Bodies and constraints";
        const std::size_t end = line.rfind(" |"), begin = line.rfind("| ", end);
        if (in_section && line.starts_with("| ") && end != std::string::npos && begin > 0)
            last_cells[line.substr(2)] = line.substr(begin + 2, end - begin - 2);
    }
    // The table's rows by their beginnings, in the order of the list of types.
    const char* const rows[] = {"contact, smooth", "contact with friction",
                                "ball-socket",     "distance",
                                "fixed",           "hinge",
                                "slider",          "point on a plane",
                                "point on a line", "rotation lock",
                                "parallel axes",   "perpendicular axes",
                                "slide drive",     "twist drive",
                                "swing limit",     "point servo",
                                "angular servo",   "gear",
                                "rack and pinion", "pulley"};
    static_assert(std::size(rows) == constraint_type_count, "a row for every type");
    for (const Isa isa : available_isas()) {
        const KernelTable& table = kernel_table(isa);
        for (int type = 0; type < constraint_type_count; ++type) {
            const char* const name = rows[type];
            const std::string measured = std::to_string(bytes(table, type, BodyKind::planar)) + " / " +
                                         std::to_string(bytes(table, type, BodyKind::rigid));
            const auto row = last_cells.lower_bound(name);
            ASSERT_TRUE(row != last_cells.end() && row->first.starts_with(name)) << name;
            EXPECT_EQ(row->second, measured) << name << " on " << isa_name(isa);
        }
    }
}

}  // namespace
}  // namespace motley
