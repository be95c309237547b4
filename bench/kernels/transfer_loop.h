// The loop that both ways share. Included inside an anonymous namespace, after Lanes, quads and gather_field.

template <class LoadQuad>
float sum_rows(const std::int32_t* index, std::int64_t count, const LoadQuad& load_quad)
{
    Lanes sum(0);
    for (std::int64_t i = 0; i < count; i += Lanes::width) {
        for (const int quad : {0, 4}) {
            Lanes fields[4];
            load_quad(quad, index + i, fields);
            sum = sum + ((fields[0] + fields[1]) + (fields[2] + fields[3]));
        }
    }
    alignas(64) float lanes[Lanes::width];
    sum.store(lanes);
    float total = 0;
    for (const float lane : lanes) total += lane;
    return total;
}

inline float sum_by_transpose(const float* rows, const std::int32_t* index, std::int64_t count)
{
    return sum_rows(index, count, [&](int quad, const std::int32_t* lanes, Lanes(&fields)[4]) {
        load_quads(rows + quad, 8, lanes, fields);
    });
}

inline float sum_by_gather(const float* rows, const std::int32_t* index, std::int64_t count)
{
    return sum_rows(index, count, [&](int quad, const std::int32_t* lanes, Lanes(&fields)[4]) {
        for (int i = 0; i < 4; ++i) fields[i] = gather_field(rows + quad + i, lanes);
    });
}
