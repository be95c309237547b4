// The median, the statistic of a series of measurements that noise of the machine changes least.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace motley::bench {

/// For an even number of values the upper of the two middle ones; 0 for no values.
inline double median(std::vector<double> values)
{
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace motley::bench
