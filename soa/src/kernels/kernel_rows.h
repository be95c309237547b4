// Loads rows into lanes and stores them. Included inside an anonymous namespace, after Lanes.
#pragma once

inline constexpr int Lanes_width = static_cast<int>(sizeof(Lanes) / sizeof(float));

template <class Row>
inline constexpr int fields_of = std::is_empty_v<Row> ? 0 : static_cast<int>(sizeof(Row) / sizeof(Lanes));

/// A row consists of Reals only, stored field by field: field i of the lanes from l on is at stream[16 i + l]. In kernels for
/// speed each field is a load or a store of its own, so that it may stay in a register; in those for size it is a loop.
inline constexpr bool is_for_speed =
    KernelShare::MOTLEY_SHARE == KernelShare::swept || KernelShare::MOTLEY_SHARE == KernelShare::unusual;

template <int count, class Work>
[[gnu::always_inline]] inline void for_each_field(const Work& work)
{
    if constexpr (is_for_speed) {
        [&]<int... field>(std::integer_sequence<int, field...>)
        {
            (work(field), ...);
        }
        (std::make_integer_sequence<int, count>{});
    } else {
        for (int field = 0; field < count; ++field) work(field);
    }
}
template <class Row>
Row load_row(const float* stream)
{
    Row row;
    Lanes* fields = reinterpret_cast<Lanes*>(&row);
    for_each_field<fields_of<Row>>(
        [&](int field) { fields[field] = load_lanes(stream + block_lanes * field); });
    return row;
}
template <class Row>
void store_row(const Row& row, float* stream)
{
    const Lanes* fields = reinterpret_cast<const Lanes*>(&row);
    for_each_field<fields_of<Row>>(
        [&](int field) { store_lanes(fields[field], stream + block_lanes * field); });
}
