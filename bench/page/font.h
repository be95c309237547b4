// The letters of a picture's legend: five dots wide, seven high, one number a row, the leftmost dot worth 16.
#pragma once

#include <array>
#include <cstdint>

namespace motley::bench {

struct Glyph {
    char letter;
    std::array<std::uint8_t, 7> rows;
};

inline constexpr std::array glyphs{
    Glyph{'0', {14, 17, 17, 17, 17, 17, 14}}, Glyph{'1', {4, 12, 4, 4, 4, 4, 14}},
    Glyph{'2', {14, 17, 1, 6, 8, 16, 31}},    Glyph{'3', {14, 17, 1, 6, 1, 17, 14}},
    Glyph{'4', {2, 6, 10, 18, 31, 2, 2}},     Glyph{'5', {31, 16, 30, 1, 1, 17, 14}},
    Glyph{'6', {14, 16, 30, 17, 17, 17, 14}}, Glyph{'7', {31, 1, 2, 4, 4, 8, 8}},
    Glyph{'8', {14, 17, 17, 14, 17, 17, 14}}, Glyph{'9', {14, 17, 17, 17, 15, 1, 14}},
    Glyph{'/', {1, 1, 2, 4, 8, 16, 16}},      Glyph{'N', {17, 25, 25, 21, 19, 19, 17}},
    Glyph{'m', {0, 0, 26, 21, 21, 21, 21}},   Glyph{'k', {16, 16, 18, 20, 24, 20, 18}},
    Glyph{'.', {0, 0, 0, 0, 0, 12, 12}},
};

}  // namespace motley::bench
