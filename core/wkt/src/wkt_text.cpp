// See wkt_text.h.
#include "wkt_text.h"

#include <charconv>
#include <cmath>
#include <vector>

#include "motley/core/invalid_input.h"

namespace motley {
namespace {

/// GEOS calls itself for every level.
constexpr int deepest = 64;

/// A word, a number or a single other character.
struct Token {
    enum class Kind : std::uint8_t { word, number, mark } kind = Kind::mark;
    std::string_view text;
    std::size_t place = 0;  ///< from 1
};

bool is_one_of(char c, std::string_view set)
{
    return set.find(c) != std::string_view::npos;
}
bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
bool is_in_number(char c)
{
    return (c >= '0' && c <= '9') || is_one_of(c, "+-.eE");
}

/// Calls work(token) for each token.
template <class Work>
void for_each_token(std::string_view text, const Work& work)
{
    constexpr std::string_view blanks = " \t\r\n";
    for (std::size_t first = 0, last = 0; first < text.size(); first = last) {
        last = first + 1;
        if (is_one_of(text[first], blanks)) continue;
        Token token;
        if (is_letter(text[first])) {
            token.kind = Token::Kind::word;
            while (last < text.size() && is_letter(text[last])) ++last;
        } else if (is_in_number(text[first])) {
            token.kind = Token::Kind::number;
            while (last < text.size() && (is_in_number(text[last]) || is_letter(text[last]))) ++last;
        }
        token.text = text.substr(first, last - first);
        token.place = first + 1;
        work(token);
    }
}

/// Not finite if it is no number.
double number_of(std::string_view text)
{
    if (!text.empty() && text[0] == '+') text.remove_prefix(1);
    double number = NAN;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size() ? number : NAN;
}

std::string upper_case(std::string_view word)
{
    std::string upper(word);
    for (char& c : upper) {
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    }
    return upper;
}

std::string at(const Token& token)
{
    return " at character " + std::to_string(token.place);
}

}  // namespace

void refuse_wkt(const std::string& what)
{
    throw InvalidInput("WKT: " + what);
}

void check_wkt_text(std::string_view text)
{
    int depth = 0;
    bool is_over = false;
    Token opened;
    for_each_token(text, [&](const Token& token) {
        if (is_over) refuse_wkt("text after the geometry" + at(token));
        if (token.kind == Token::Kind::number && !std::isfinite(number_of(token.text)))
            refuse_wkt("no finite number: " + std::string(token.text) + at(token));
        if (token.kind == Token::Kind::word) {
            const std::string word = upper_case(token.text);
            if (word == "NAN" || word == "INF" || word == "INFINITY")
                refuse_wkt("no finite number: " + std::string(token.text) + at(token));
            is_over = word == "EMPTY" && depth == 0;
        }
        if (token.kind != Token::Kind::mark) return;
        if (token.text == "(") {
            if (++depth > deepest) refuse_wkt("more than 64 parentheses in each other" + at(token));
            if (depth == 1) opened = token;
        } else if (token.text == ")") {
            if (--depth < 0) refuse_wkt("a parenthesis that was not opened" + at(token));
            is_over = depth == 0;
        } else if (token.text != ",") {
            refuse_wkt("a character that WKT does not have" + at(token));
        }
    });
    if (depth > 0) refuse_wkt("a parenthesis that is not closed" + at(opened));
}

std::string find_open_ring(std::string_view text)
{
    std::string shape, open;
    std::vector<std::string_view> numbers, first, last;  // of a point, and the points of a list at its ends
    const auto end_point = [&] {
        if (first.empty()) first = numbers;
        last = numbers;
        numbers.clear();
    };
    for_each_token(text, [&](const Token& token) {
        if (token.kind == Token::Kind::number) numbers.push_back(token.text);
        if (token.kind == Token::Kind::word && token.text.size() > 2) shape = upper_case(token.text);
        if (token.text == ",") end_point();
        if (token.text == ")" || token.text == "(") {
            if (token.text == ")") end_point();
            const bool is_ring = shape == "POLYGON" || shape == "MULTIPOLYGON" || shape == "LINEARRING";
            if (open.empty() && is_ring && first.size() >= 2 && last.size() >= 2 &&
                (number_of(first[0]) != number_of(last[0]) || number_of(first[1]) != number_of(last[1])))
                open = "ring from (" + std::string(first[0]) + " " + std::string(first[1]) + ") to (" +
                       std::string(last[0]) + " " + std::string(last[1]) + ")";
            first.clear();
            last.clear();
            numbers.clear();
        }
    });
    return open;
}

}  // namespace motley
