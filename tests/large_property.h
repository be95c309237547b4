// Properties of large inputs. RapidCheck's containers have at most a hundred elements, which fit one chunk of everything
// that works in chunks. So here RapidCheck decides on sizes and a seed, and the elements come from a generator with that
// seed.
#pragma once

#include <rapidcheck/gtest.h>

#include <cstdint>
#include <iostream>
#include <random>
#include <sstream>
#include <string>

namespace motley::testing {

/// As RC_GTEST_PROP, but with few cases: a hundred large ones would take minutes under a sanitizer. The same seed is
/// taken in RC_PARAMS.
template <class Property>
void check_large(int cases, const Property& property)
{
    const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
    rc::detail::TestMetadata metadata;
    metadata.id = std::string(test->test_suite_name()) + "/" + test->name();
    metadata.description = test->name();
    rc::detail::TestParams params = rc::detail::configuration().testParams;
    params.maxSuccess = cases;
    const auto result = rc::detail::checkTestable(property, metadata, params);
    if (result.template is<rc::detail::SuccessResult>()) return;
    std::ostringstream text;
    rc::detail::printResultMessage(result, text);
    FAIL() << text.str();
}

/// A generator whose seed RapidCheck decides on.
inline std::mt19937_64 any_random()
{
    return std::mt19937_64(*rc::gen::arbitrary<std::uint32_t>());
}
/// A size in [low, high): RapidCheck begins with the smallest.
inline std::size_t any_size(std::size_t low, std::size_t high)
{
    return *rc::gen::inRange(low, high);
}

}  // namespace motley::testing
