// Lists of types.
#pragma once

namespace motley {

template <class... Types>
struct TypeList {
    static constexpr int size = sizeof...(Types);
};

/// The concatenation of several lists.
template <class... Lists>
struct JoinedLists {
    using type = TypeList<>;  // of no lists
};
template <class... Types>
struct JoinedLists<TypeList<Types...>> {
    using type = TypeList<Types...>;
};
template <class... First, class... Second, class... Rest>
struct JoinedLists<TypeList<First...>, TypeList<Second...>, Rest...> {
    using type = typename JoinedLists<TypeList<First..., Second...>, Rest...>::type;
};
template <class... Lists>
using Joined = typename JoinedLists<Lists...>::type;

}  // namespace motley
