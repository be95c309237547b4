// The structs of the C interface beside those of C++: each pair has one list of their fields, from which follow conversions
// in both directions, defaults, and what the compiler checks: that no field is forgotten, and that structs which never
// change have the same layout.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "call.h"
#include "maths/bit_cast.h"

namespace motley::c {

/// A member of a struct C and its namesake in a struct Cpp.
template <auto c_member_, auto cpp_member_, std::size_t c_offset_, std::size_t cpp_offset_>
struct Field {
    static constexpr auto c_member = c_member_;
    static constexpr auto cpp_member = cpp_member_;
    static constexpr bool same_place = c_offset_ == cpp_offset_;
    const char* name;
};

/// Specialised for every pair, as a struct that inherits Pair and lists `fields` by MOTLEY_FIELD.
template <class C, class Cpp>
struct Mirror;

template <class C_, class Cpp_>
struct Pair {
    using C = C_;
    using Cpp = Cpp_;
    /// Fields of Cpp that are converted by hand.
    static constexpr std::size_t by_hand = 0;
};
#define MOTLEY_FIELD(name)                                              \
    Field<&C::name, &Cpp::name, offsetof(C, name), offsetof(Cpp, name)> \
    {                                                                   \
#name                                                           \
    }

/// Converts to anything: with how many of it a struct can be initialised is the number of its fields.
struct Anything {
    template <class T>
    operator T() const;  // NOLINT(google-explicit-constructor)
};
template <class T, std::size_t... n>
constexpr bool is_made_of(std::index_sequence<n...>)
{
    return requires
    {
        T{(static_cast<void>(n), Anything{})...};
    };
}
/// Number of fields of a struct; every element of a plain array counts.
template <class T, std::size_t most = 48>
constexpr std::size_t field_count()
{
    if constexpr (most == 0 || is_made_of<T>(std::make_index_sequence<most>{})) {
        return most;
    } else {
        return field_count<T, most - 1>();
    }
}

/// Whether every field of Cpp is in the list, or is converted by hand.
template <class C, class Cpp>
constexpr bool lists_every_field()
{
    const auto count = [](auto field) {
        using Member = std::remove_reference_t<decltype(std::declval<Cpp&>().*field.cpp_member)>;
        return std::is_array_v<Member> ? std::extent_v<Member> : 1;
    };
    const std::size_t listed =
        std::apply([&](auto... field) { return (count(field) + ...); }, Mirror<C, Cpp>::fields);
    return listed + Mirror<C, Cpp>::by_hand == field_count<Cpp>();
}

/// Whether one may be read as the other.
template <class C, class Cpp>
constexpr bool same_layout()
{
    const auto same = [](auto field) {
        return field.same_place &&
               sizeof(std::declval<C&>().*field.c_member) == sizeof(std::declval<Cpp&>().*field.cpp_member);
    };
    return sizeof(C) == sizeof(Cpp) && alignof(C) == alignof(Cpp) && lists_every_field<C, Cpp>() &&
           std::apply([&](auto... field) { return (same(field) && ...); }, Mirror<C, Cpp>::fields);
}

/// Number of values of an enumeration that hosts write: 0 to this less 1.
template <class Enum>
inline constexpr int value_count = 0;

/// Which field of which struct; a text only where one is refused.
struct FieldName {
    const char* owner;
    const char* field;
    [[nodiscard]] std::string text() const { return std::string(owner) + "." + field; }
};

/// The value of one field of the host.
template <class From, class To>
void take(const From& from, To& to, const FieldName& name)
{
    if constexpr (std::is_array_v<To>) {
        for (std::size_t i = 0; i < std::extent_v<To>; ++i) take(from[i], to[i], name);
    } else if constexpr (std::is_same_v<To, bool>) {
        if (from != 0 && from != 1) refuse(name.text(), from, "0 or 1");
        to = from == 1;
    } else if constexpr (std::is_enum_v<To>) {
        static_assert(value_count<To> > 0);
        if (from < 0 || from >= value_count<To>)
            refuse(name.text(), from, "0 to " + std::to_string(value_count<To> - 1));
        to = static_cast<To>(from);
    } else if constexpr (std::is_same_v<From, To>) {
        to = from;
    } else {
        static_assert(same_layout<From, To>());
        to = motley::bit_cast<To>(from);
    }
}

/// The value of one field for the host. A text that is too long is cut off.
template <class From, class To>
void give(const From& from, To& to)
{
    if constexpr (std::is_same_v<From, std::string>) {
        std::snprintf(to, sizeof to, "%s", from.c_str());
    } else if constexpr (std::is_array_v<To>) {
        static_assert(std::tuple_size_v<decltype(std::to_array(to))> >= sizeof(From) / sizeof from[0]);
        for (std::size_t i = 0; i < sizeof(From) / sizeof from[0]; ++i) give(from[i], to[i]);
    } else if constexpr (std::is_same_v<From, bool> || std::is_enum_v<From>) {
        to = static_cast<To>(from);
    } else if constexpr (std::is_same_v<From, To>) {
        to = from;
    } else {
        static_assert(same_layout<To, From>());
        to = motley::bit_cast<To>(from);
    }
}

template <class C, class Cpp>
void take_fields(const C& from, Cpp& to)
{
    static_assert(lists_every_field<C, Cpp>(), "the struct of C++ has a field that the Mirror does not list");
    const auto take_one = [&](const auto& field) {
        take(from.*field.c_member, to.*field.cpp_member, FieldName{Mirror<C, Cpp>::name, field.name});
    };
    std::apply([&](const auto&... field) { (take_one(field), ...); }, Mirror<C, Cpp>::fields);
}

template <class Cpp, class C>
void give_fields(const Cpp& from, C& to)
{
    static_assert(lists_every_field<C, Cpp>(), "the struct of C++ has a field that the Mirror does not list");
    std::apply([&](const auto&... field) { (give(from.*field.cpp_member, to.*field.c_member), ...); },
               Mirror<C, Cpp>::fields);
}

/// The size of C in version 1 of the interface. A struct that has grown since says here what it was.
template <class C>
inline constexpr std::size_t first_size = sizeof(C);

/// Refuses the size of a struct that no version up to this one has had.
template <class C>
void check_size(std::size_t size, const char* name)
{
    if (size >= first_size<C> && size <= sizeof(C)) return;
    std::string expected = std::to_string(sizeof(C));
    if (first_size<C> < sizeof(C)) expected = std::to_string(first_size<C>) + " to " + expected;
    refuse(std::string(name) + ".struct_size", std::to_string(size),
           expected + ", as its initialiser sets it");
}

/// Writes a struct as far as the host knows it, whose `struct_size` it has.
template <class C>
void give_known(const C& full, C& to)
{
    std::memcpy(&to, &full, full.struct_size);
}

/// A struct with defaults, of which an older host knows the first `struct_size` bytes.
template <class Cpp, class C>
void initialise(C* value, std::size_t struct_size)
{
    need(value, "value");
    check_size<C>(struct_size, Mirror<C, Cpp>::name);
    C defaults{};
    give_fields(Cpp{}, defaults);
    defaults.struct_size = struct_size;
    give_known(defaults, *value);
}

/// A struct of the host in full: what an older host does not know has its default.
template <class Cpp, class C>
C in_full(const C* given, const char* name)
{
    need(given, name);
    check_size<C>(given->struct_size, Mirror<C, Cpp>::name);
    C full{};
    give_fields(Cpp{}, full);
    std::memcpy(&full, given, given->struct_size);
    return full;
}

template <class Cpp, class C>
Cpp read(const C* given, const char* name)
{
    Cpp value;
    take_fields(in_full<Cpp>(given, name), value);
    return value;
}

/// Element i of an array of structs of the host, which check_array() has let pass.
template <class C>
const C* element(const C* first, std::size_t i, std::size_t stride)
{
    return reinterpret_cast<const C*>(reinterpret_cast<const std::byte*>(first) + i * stride);
}

/// What an array of structs of the host says.
template <class Cpp, class C>
std::vector<Cpp> read_all(const C* first, std::size_t count, std::size_t stride, const char* name)
{
    check_array(first, count, stride, first_size<C>, alignof(C), name);
    std::vector<Cpp> values;
    values.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const C* given = element(first, i, stride);
        if (given->struct_size > stride) {
            refuse(std::string(name) + ", its stride", std::to_string(stride),
                   "the struct_size of its elements or more");
        }
        values.push_back(read<Cpp>(given, name));
    }
    return values;
}

/// Writes the first `capacity` elements of the list that `read_list` returns, and how many there are.
template <class C, class ReadList>
void give_list(std::size_t capacity, C* to, const char* name, std::size_t* count, const ReadList& read_list)
{
    need(count, "count");
    check_array(to, capacity, sizeof(C), sizeof(C), alignof(C), name);
    auto list = read_list();
    static_assert(same_layout<C, typename decltype(list)::value_type>());
    const std::size_t given = std::min(capacity, list.size());
    if (given > 0) std::memcpy(to, list.data(), given * sizeof(C));
    *count = list.size();
}

/// Writes where a list of the library is, and its length.
template <class C, class Cpp>
void give_view(std::span<const Cpp> list, const C** to, const char* name, std::size_t* count)
{
    static_assert(same_layout<C, Cpp>());
    const C*& first = need(to, name);
    need(count, "count") = list.size();
    first = reinterpret_cast<const C*>(list.data());
}

}  // namespace motley::c

/// Defines the initialiser of motley_NAME, whose defaults are those of Cpp.
#define MOTLEY_DEFINE_DEFAULT(name, Cpp)                                                           \
    motley_status motley_init_##name(motley_##name* value, size_t struct_size)                     \
    {                                                                                              \
        return motley::c::call(__func__, [&] { motley::c::initialise<Cpp>(value, struct_size); }); \
    }
