// The bytes a lane in the table of bench/README.md are those that the kernels stream.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "kernels/kernel_table.h"

namespace motley {
namespace {

int bytes(const KernelTable& table, int type, BodyKind kind)
{
    const ConstraintKernels& kernels = table.constraints[class_of(type, kind, kind)];
    return 4 * (kernels.swept_floats + kernels.impulse_floats + 2);  // 2: the body indices
}

TEST(Readme, BytesALaneAreWhatTheKernelsStream)
{
    std::ifstream file(MOTLEY_BENCH_README);
    ASSERT_TRUE(file) << MOTLEY_BENCH_README;
    std::map<std::string, std::string> bytes_cells;  // of the table's rows, by their first cell
    bool in_section = false;
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("## ")) in_section = line == "## Kernels of every constraint";
        if (!in_section || !line.starts_with("| ")) continue;
        std::vector<std::string> cells;
        std::istringstream cut(line.substr(1));
        for (std::string cell; std::getline(cut, cell, '|');)
            cells.push_back(cell.substr(1, cell.size() > 1 ? cell.size() - 2 : 0));
        if (cells.size() > 1) bytes_cells[cells[0]] = cells[1];
    }
    // The beginnings of the table's rows, in the order of the list of types.
    const char* const rows[] = {"contact, smooth",
                                "contact with friction",
                                "contact that bounces",
                                "ball-socket",
                                "distance",
                                "fixed",
                                "hinge",
                                "slider",
                                "point on a plane",
                                "point on a line",
                                "rotation lock",
                                "parallel axes",
                                "perpendicular axes",
                                "slide drive",
                                "twist drive",
                                "Euler drive",
                                "swing limit",
                                "point servo",
                                "angular servo",
                                "gear",
                                "rack and pinion",
                                "pulley",
                                "manifold",
                                "screw"};
    static_assert(std::size(rows) == constraint_type_count,
                  "every type of constraint_types.h has a row here, in the order of the list, and one in the "
                  "table of bench/README.md");
    for (const Isa isa : available_isas()) {
        const KernelTable& table = kernel_table(isa);
        for (int type = 0; type < constraint_type_count; ++type) {
            const char* const name = rows[type];
            const std::string measured = std::to_string(bytes(table, type, BodyKind::planar)) + " / " +
                                         std::to_string(bytes(table, type, BodyKind::rigid));
            const auto row = bytes_cells.lower_bound(name);
            ASSERT_TRUE(row != bytes_cells.end() && row->first.starts_with(name))
                << "bench/README.md lacks the row | " << name << " | " << measured << " | ... |";
            EXPECT_EQ(row->second, measured) << name << " on " << isa_name(isa);
        }
    }
}

}  // namespace
}  // namespace motley
