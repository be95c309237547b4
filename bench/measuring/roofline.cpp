#include "measuring/roofline.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>

#include "contract/constraint_types.h"
#include "maths/lane_body.h"
#include "maths/step_constants.h"
#include "measuring/clock.h"
#include "measuring/median.h"
#include "stores/aligned_vector.h"
#include "worlds/tie_net.h"

namespace motley::bench {
namespace {

// ---- operations of a kernel, counted by running its maths on a number that counts -------------------------------

struct Counted;
/// The result of a comparison. The maths never branches on it; it selects.
struct CountedMask {
    bool bits;
    [[maybe_unused]] friend CountedMask operator&(CountedMask x, CountedMask y) { return {x.bits && y.bits}; }
};
struct Counted {
    float value = 1;
    static inline long operations = 0;
    Counted() = default;
    explicit Counted(float v) : value(v) {}
    static Counted counted(float v)
    {
        ++operations;
        return Counted(v);
    }
    friend Counted operator+(Counted x, Counted y) { return counted(x.value + y.value); }
    friend Counted operator-(Counted x, Counted y) { return counted(x.value - y.value); }
    friend Counted operator*(Counted x, Counted y) { return counted(x.value * y.value); }
    friend Counted operator/(Counted x, Counted y) { return counted(x.value / y.value); }
    friend Counted operator-(Counted x) { return Counted(-x.value); }
    friend CountedMask operator<(Counted x, Counted y) { return {x.value < y.value}; }
    friend CountedMask operator>(Counted x, Counted y) { return {x.value > y.value}; }
    friend Counted select(CountedMask mask, Counted x, Counted y) { return mask.bits ? x : y; }
    friend Counted square_root(Counted x) { return counted(std::sqrt(x.value)); }
};

/// Additions, multiplications, divisions and roots of one solve of one constraint.
template <class Type, BodyKind kind>
double operations_of()
{
    LaneBody<Counted, kind> a, b;
    typename Type::template Row<Counted, kind, kind> row;
    typename Type::template SubstepRow<Counted, kind, kind> substep;
    typename Type::template Impulse<Counted, kind, kind> impulse;
    const StepConstants step;
    Counted::operations = 0;
    if constexpr (requires { row.in_sweep; }) {
        Type::template solve<Counted>(step, row.in_sweep, substep, impulse, a, b);
    } else {
        Type::template solve<Counted>(step, row, substep, impulse, a, b);
    }
    return static_cast<double>(Counted::operations);
}

const std::map<std::string, double>& operations()
{
    static const std::map<std::string, double> all{
        {"smooth_contact/planar", operations_of<SmoothContact, BodyKind::planar>()},
        {"contact/planar", operations_of<RoughContact, BodyKind::planar>()},
        {"contact/rigid", operations_of<RoughContact, BodyKind::rigid>()},
        {"ball_socket/planar", operations_of<BallSocket, BodyKind::planar>()},
        {"ball_socket/rigid", operations_of<BallSocket, BodyKind::rigid>()},
        {"hinge/rigid", operations_of<FrameJointOf<HingeDefinition>::type, BodyKind::rigid>()},
        {"fixed/rigid", operations_of<FrameJointOf<FixedDefinition>::type, BodyKind::rigid>()}};
    return all;
}

// ---- the machine -------------------------------------------------------------------------------------------------

/// Best rate of x = y + s z over arrays of `floats`, counting three streams.
double triad(std::size_t floats, int threads)
{
    const std::unique_ptr<Solver> lender =
        std::make_unique<Solver>(SolverSettings{}, SolverOptions{.threads = threads});
    AlignedVector<float> x(floats, 0.0F), y(floats, 1.0F), z(floats, 2.0F);
    const int passes = static_cast<int>(std::max<std::size_t>(1, (std::size_t{1} << 24) / floats));
    double best = 0;
    for (int round = 0; round < 8; ++round) {
        const double began = now();
        lender->executor().run(threads, [&](int worker) {
            const std::size_t first =
                floats * static_cast<std::size_t>(worker) / static_cast<std::size_t>(threads);
            const std::size_t last =
                floats * static_cast<std::size_t>(worker + 1) / static_cast<std::size_t>(threads);
            float* __restrict to = x.data();
            const float* __restrict from = y.data(), * __restrict scaled = z.data();
            for (int pass = 0; pass < passes; ++pass) {
                const float s = 0.5F + static_cast<float>(pass);
                for (std::size_t i = first; i < last; ++i) to[i] = from[i] + s * scaled[i];
            }
        });
        best = std::max(best, 12.0 * static_cast<double>(floats) * passes / (now() - began));
    }
    return best;
}

/// Eight independent chains of multiply and add: the peak rate without fusing. Inlined into a function of each
/// instruction set.
template <class Vector>
[[gnu::always_inline]] inline double multiply_and_add()
{
    constexpr long rounds = 20'000'000;
    Vector chains[8];
    for (int i = 0; i < 8; ++i) chains[i] = Vector{} + (1.0F + 0.1F * static_cast<float>(i));
    const Vector scale = Vector{} + 0.999999F, step = Vector{} + 1e-6F;
    const double began = now();
    for (long round = 0; round < rounds; ++round) {
        for (Vector& chain : chains) chain = chain * scale + step;
    }
    const double seconds = now() - began;
    Vector sum{};
    for (const Vector& chain : chains) sum = sum + chain;
    float lanes[sizeof(Vector) / sizeof(float)];
    std::memcpy(lanes, &sum, sizeof(Vector));
    constexpr double operations = 2 * 8 * static_cast<double>(sizeof(Vector) / sizeof(float));
    return lanes[0] > 0 ? operations * static_cast<double>(rounds) / seconds : 0;
}

using Four = float __attribute__((vector_size(16)));
double peak_of_one()
{
    return multiply_and_add<float>();
}
double peak_of_four()
{
    return multiply_and_add<Four>();
}
#if defined(__x86_64__)
using Eight = float __attribute__((vector_size(32)));
using Sixteen = float __attribute__((vector_size(64)));
[[gnu::target("avx2")]] double peak_of_eight()
{
    return multiply_and_add<Eight>();
}
[[gnu::target("avx512f")]] double peak_of_sixteen()
{
    return multiply_and_add<Sixteen>();
}
#endif

double peak(Isa isa)
{
    switch (isa) {
        case Isa::scalar:
            return peak_of_one();
#if defined(__x86_64__)
        case Isa::avx2:
            return peak_of_eight();
        case Isa::avx512:
            return peak_of_sixteen();
#endif
        default:
            return peak_of_four();
    }
}

}  // namespace

double memory_triad(int threads)
{
    constexpr std::size_t far_beyond_caches = std::size_t{1} << 25;
    return triad(far_beyond_caches, threads);
}

MachineLimits measure_machine(Isa isa)
{
    constexpr std::size_t within_second_level = std::size_t{1} << 16;
    return {memory_triad(1), memory_triad(2), triad(within_second_level, 1), peak(isa)};
}

KernelFigure measure_kernel(const std::string& name, Isa isa, bool in_cache)
{
    const NamedTie tie = tie_called(name);
    const auto net = make_net(tie.tie, tie.model, in_cache ? side_in_cache : side_streaming);
    constexpr int iterations = 32;
    Solver solver({.substeps = 1, .iterations = iterations, .relaxations = 0}, {.isa = isa});
    std::vector<double> seconds;
    StepReport report;
    for (int step = 0; step < (in_cache ? 60 : 6); ++step) {
        report = solver.step(net->scene, 1e-3F, net->contacts);
        if (report.status != StepStatus::done) throw std::runtime_error(report.error);
        seconds.push_back(report.seconds[static_cast<std::size_t>(Stage::solve)]);
    }
    const auto constraints = static_cast<double>(report.contacts + report.joints);
    const auto counted = operations().find(name);
    return {name,
            in_cache,
            isa,
            constraints,
            median(seconds) / (iterations * constraints),
            report.bytes_per_constraint,
            counted == operations().end() ? 0 : counted->second};
}

std::vector<KernelFigure> measure_kernels(Isa isa)
{
    std::vector<KernelFigure> all;
    for (const auto& [name, count] : operations()) {
        for (const bool in_cache : {true, false}) all.push_back(measure_kernel(name, isa, in_cache));
    }
    return all;
}

}  // namespace motley::bench
