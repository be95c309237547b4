// The joint scenes that other engines have been measured on, with the same numbers: how many times faster, at no more error.
#pragma once

#include <string>
#include <vector>

namespace motley::bench {

struct AnchorOptions {
    int rounds = 3;
    bool quick = false;  ///< a tenth of the bodies: shows that it runs, not how fast
    bool progress = true;
};

/// One scene: the fastest settings of motley that part no more than Box3D does, on one thread and on two.
struct AnchorResult {
    std::string scene;
    double most_error = 0;  ///< of Box3D, m rms
    struct Line {
        std::string label;
        double seconds = 0, error = 0;  ///< a step; m rms
    };
    std::vector<Line> motley;  ///< on one thread and on two; empty where no setting is exact enough
    double bullet_seconds =
        -1;  ///< its solver alone, run in turn with them; negative where it is not installed
    double host_load = 0;
};

std::vector<AnchorResult> measure_anchors(const AnchorOptions& options);
std::string table_of(const std::vector<AnchorResult>& results);

}  // namespace motley::bench
