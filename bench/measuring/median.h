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

/// The median over means of eight values one after another: of steps that search for contacts every few steps, each
/// mean has its share of searches.
inline double median_of_eights(const std::vector<double>& values)
{
    constexpr std::size_t eight = 8;
    std::vector<double> means;
    for (std::size_t first = 0; first < values.size(); first += eight) {
        const std::size_t last = std::min(first + eight, values.size());
        if (last - first < eight && first > 0) break;
        double sum = 0;
        for (std::size_t i = first; i < last; ++i) sum += values[i];
        means.push_back(sum / static_cast<double>(last - first));
    }
    return median(means);
}

}  // namespace motley::bench
