// The middle of some measurements: what the noise of a machine moves least.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace motley::bench {

/// The upper of the two middle ones where they are even in number; 0 where there are none.
inline double median(std::vector<double> values)
{
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace motley::bench
