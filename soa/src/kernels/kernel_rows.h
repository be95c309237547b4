// Loads rows into lanes and stores them. Included inside an anonymous namespace, after Lanes.
#pragma once

inline constexpr int Lanes_width = static_cast<int>(sizeof(Lanes) / sizeof(float));

template <class... Numbers>
void unused(const Numbers&...)
{
}

template <class Row>
inline constexpr int fields_of = std::is_empty_v<Row> ? 0 : static_cast<int>(sizeof(Row) / sizeof(Lanes));

/// Kernels of the other shares are for size: see KernelShare.
inline constexpr bool is_for_speed =
    KernelShare::MOTLEY_SHARE == KernelShare::swept || KernelShare::MOTLEY_SHARE == KernelShare::unusual;

/// A row consists of Reals only, stored field by field: field i of the lanes from l on is at stream[16 i + l]. Each field is a
/// load of its own, so that those without a reader are dropped. So is each store in kernels for speed, where fields are in
/// registers; in those for size it is a loop.
template <class Row, int... field>
void load_fields(Row& row, const float* stream, std::integer_sequence<int, field...>)
{
    Lanes* fields = reinterpret_cast<Lanes*>(&row);
    ((fields[field] = load_lanes(stream + block_lanes * field)), ...);
    unused(fields, stream);
}
template <class Row, int... field>
void store_fields(const Row& row, float* stream, std::integer_sequence<int, field...>)
{
    const Lanes* fields = reinterpret_cast<const Lanes*>(&row);
    (store_lanes(fields[field], stream + block_lanes * field), ...);
    unused(fields, stream);
}
template <class Row>
Row load_row(const float* stream)
{
    Row row;
    load_fields(row, stream, std::make_integer_sequence<int, fields_of<Row>>{});
    return row;
}
template <class Row>
void store_row(const Row& row, float* stream)
{
    if constexpr (is_for_speed) {
        store_fields(row, stream, std::make_integer_sequence<int, fields_of<Row>>{});
    } else {
        const Lanes* fields = reinterpret_cast<const Lanes*>(&row);
        for (int i = 0; i < fields_of<Row>; ++i) store_lanes(fields[i], stream + block_lanes * i);
    }
}
