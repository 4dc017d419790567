// Delaunay triangulation by CGAL's hierarchy (Fast_location), one point after the other: a program of its own, never linked with
// brio.
//   cgal_hierarchy POINTS [--scratch DIR] [--progress]    POINTS: raw little-endian doubles, x y z of each point, in the order of
//                                                         insertion
// With DIR, vertices and cells are in an unlinked file there, as brio's are, so that a limit of memory slows it down instead of
// ending it. Progress goes to standard error, a line a per cent; standard output has what `brio delaunay --json` says of the same
// work.
#include <cstdlib>
#include <fcntl.h>
#include <string>
#include <sys/mman.h>
#include <unistd.h>

namespace scratch {

static const size_t RESERVED = size_t{1} << 38; // of addresses; the file is as long, and sparse
static std::string folder;
static char *base = nullptr, *next = nullptr;

inline void *take(size_t bytes) {
    if (folder.empty()) return std::malloc(bytes);
    if (!base) {
        const std::string path = folder + "/cgal-scratch";
        const int file = open(path.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
        if (file < 0 || unlink(path.c_str()) || ftruncate(file, off_t(RESERVED))) std::exit(6);
        base = next = static_cast<char *>(mmap(nullptr, RESERVED, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0));
        if (base == MAP_FAILED) std::exit(4);
        madvise(base, RESERVED, MADV_RANDOM);
    }
    char *const taken = next;
    next += (bytes + 63) / 64 * 64;
    if (next > base + RESERVED) std::exit(4);
    return taken;
}

// Blocks in the file are given back with it.
inline void give(void *block) {
    if (folder.empty()) std::free(block);
}

template <class T> struct allocator {
    using value_type = T;
    allocator() = default;
    template <class U> allocator(const allocator<U> &) {}
    T *allocate(size_t count) { return static_cast<T *>(take(count * sizeof(T))); }
    void deallocate(T *block, size_t) { give(block); }
    template <class U> bool operator==(const allocator<U> &) const { return true; }
    template <class U> bool operator!=(const allocator<U> &) const { return false; }
};

} // namespace scratch

#define CGAL_ALLOCATOR(T) scratch::allocator<T>
#include "cgal_points.hpp"
#include <CGAL/Delaunay_triangulation_3.h>
#include <cstring>

using Triangulation = CGAL::Delaunay_triangulation_3<Kernel, CGAL::Fast_location>;

int main(int argc, char **argv) {
    for (int i = 2; i + 1 < argc; i++)
        if (!std::strcmp(argv[i], "--scratch")) scratch::folder = argv[i + 1];
    if (argc < 2) return std::fprintf(stderr, "usage: cgal_hierarchy POINTS [--scratch DIR] [--progress]\n"), 1;
    const peer::Stopwatch reading;
    const std::vector<Kernel::Point_3> points = read_points(argv[1]);
    const double read = reading.seconds();
    const peer::Stopwatch watch;
    Triangulation t;
    size_t told = 0;
    for (size_t i = 0; i < points.size(); i++) {
        t.insert(points[i]);
        for (; told * points.size() <= 100 * i; told++) std::fprintf(stderr, "insert %zu %%\n", told);
    }
    const double insert = watch.seconds();
    std::printf("{\"vertices\": %zu, \"tetrahedra\": %zu, \"peak_bytes\": %llu, \"internals\": {}, \"library\": \"%s\", "
                "\"seconds\": {\"read\": %.4f, \"order\": 0, \"insert\": %.4f}}\n",
                t.number_of_vertices(), t.number_of_finite_cells(), peer::peak_bytes(), LIBRARY, read, insert);
    std::fflush(stdout);
    std::_Exit(0); // cells are not freed one by one
}
