// What the drivers share: raw points in, one line of facts out.
#ifndef PEER_HPP
#define PEER_HPP

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

namespace peer {

// The numbers of a file, `columns` to a point.
inline std::vector<double> read_numbers(const char *path, size_t columns) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) std::fprintf(stderr, "%s cannot be read\n", path), std::exit(2);
    std::vector<double> points(static_cast<size_t>(file.tellg()) / sizeof(double) / columns * columns);
    file.seekg(0);
    file.read(reinterpret_cast<char *>(points.data()), static_cast<std::streamsize>(points.size() * sizeof(double)));
    return points;
}

// x y z of each point, one point after the other.
inline std::vector<double> read_points(const char *path) { return read_numbers(path, 3); }

// Seconds since it was made.
class Stopwatch {
  public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); }

  private:
    const std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
};

// Processor seconds of this process since it was made: comparable where other work shares the machine.
class Processor_clock {
  public:
    double seconds() const { return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC; }

  private:
    const std::clock_t start = std::clock();
};

// Peak resident bytes of this process. getrusage would count what its parent held before the start.
inline unsigned long long peak_bytes() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        unsigned long long kib;
        if (word == "VmHWM:" && status >> kib) return kib * 1024;
    }
    return 0;
}

// The line that bench.py reads.
inline int report(size_t vertices, size_t tetrahedra, double seconds, const char *library) {
    std::printf("%zu %zu %.4f %llu %s\n", vertices, tetrahedra, seconds, peak_bytes(), library);
    return 0;
}

} // namespace peer

#endif
