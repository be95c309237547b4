// Joint scenes on which other engines have been measured, in the same sizes: how many times as fast motley is at no
// larger error.
#pragma once

#include <string>
#include <vector>

namespace motley::bench {

struct AnchorOptions {
    int rounds = 3;
    bool quick = false;  ///< a tenth of the bodies: checks that it runs; its times mean nothing
    bool progress = true;
};

/// One scene: the fastest settings of motley whose joints part no more than Box3D's, on one thread and on two.
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
