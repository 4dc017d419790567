// What the drivers share: many sets of points in, what was computed of each out. Each driver is a program of its own; those
// of other libraries are never linked with brio.
//   driver MODE SETS OUT
// SETS: for each set the numbers n, dimension, weighted (64 bits each), a parameter (double), n * dimension coordinates, and n
// weights if weighted. OUT: for each set the numbers status (0: done), rows, columns, rows * columns indices (32 bits), rows
// values (doubles; of rows without one: 0), 8 facts (doubles). Indices that a row does not need are 2^32 - 1.
#ifndef SETS_HPP
#define SETS_HPP

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace sets {

struct Set {
    uint64_t n = 0, dimension = 0, weighted = 0;
    double parameter = 0;
    std::vector<double> x, w;
    const double *at(size_t i) const { return x.data() + dimension * i; }
};

struct Result {
    uint64_t status = 0, columns = 1;
    std::vector<uint32_t> index;
    std::vector<double> value;
    double fact[8] = {0};

    void row(std::initializer_list<uint32_t> indices, double v = 0) {
        for (uint32_t i : indices) index.push_back(i);
        for (size_t i = indices.size(); i < columns; i++) index.push_back(UINT32_MAX);
        value.push_back(v);
    }
};

template <class T> bool get(std::FILE *f, T *to, size_t n) { return std::fread(to, sizeof(T), n, f) == n; }

inline bool read_set(std::FILE *f, Set &s) {
    if (!get(f, &s.n, 1) || !get(f, &s.dimension, 1) || !get(f, &s.weighted, 1) || !get(f, &s.parameter, 1)) return false;
    s.x.resize(s.n * s.dimension), s.w.assign(s.n, 0);
    return get(f, s.x.data(), s.x.size()) && (!s.weighted || get(f, s.w.data(), s.n));
}

inline void write_result(std::FILE *f, const Result &r) {
    const uint64_t head[3] = {r.status, r.value.size(), r.columns};
    std::fwrite(head, sizeof *head, 3, f);
    std::fwrite(r.index.data(), sizeof(uint32_t), r.index.size(), f);
    std::fwrite(r.value.data(), sizeof(double), r.value.size(), f);
    std::fwrite(r.fact, sizeof(double), 8, f);
}

// Runs solve(mode, set, result) for every set.
template <class Solve> int run(int argc, char **argv, Solve solve) {
    if (argc != 4) return std::fprintf(stderr, "usage: %s MODE SETS OUT\n", argv[0]), 1;
    std::FILE *in = std::fopen(argv[2], "rb"), *out = std::fopen(argv[3], "wb");
    if (!in || !out) return std::fprintf(stderr, "%s or %s cannot be opened\n", argv[2], argv[3]), 2;
    for (Set s; read_set(in, s);) {
        Result r;
        solve(argv[1], s, r);
        write_result(out, r);
    }
    std::fclose(in);
    return std::fclose(out) ? 2 : 0;
}

} // namespace sets

#endif
