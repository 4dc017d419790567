/* Runs a fuzzer without libFuzzer: fuzz_SUBJECT [--inputs N] [FILE|FOLDER...].
 *
 * Every file is an input. Then follow N inputs that are made of the files by simple changes, the same ones in every run:
 * bytes overwritten, cut out, repeated, swapped for those of another file, or the end cut off. */
#include "base/rng.h"
#include "fuzz.h"
#include <dirent.h>
#include <sys/stat.h>

enum { MOST_FILES = 512, LONGEST = 1 << 16 };

typedef struct {
    uint8_t *bytes;
    size_t size;
} seed;

static seed seeds[MOST_FILES];
static size_t num_seeds;

static void add_file(const char *path) {
    FILE *f = fopen(path, "rb");
    seed s = {malloc(LONGEST), 0};
    if (!f || !s.bytes || num_seeds == MOST_FILES) {
        fprintf(stderr, "%s: cannot be read\n", path);
        exit(1);
    }
    s.size = fread(s.bytes, 1, LONGEST, f);
    fclose(f);
    seeds[num_seeds++] = s;
}

static void add(const char *path) {
    struct dirent **entries;
    int count = scandir(path, &entries, NULL, alphasort);
    if (count < 0) {
        add_file(path);
        return;
    }
    for (int i = 0; i < count; i++) {
        char file[4096];
        snprintf(file, sizeof file, "%s/%s", path, entries[i]->d_name);
        if (entries[i]->d_name[0] != '.') add_file(file);
        free(entries[i]);
    }
    free(entries);
}

/* From an exact copy, so that the address sanitizer sees a read behind the end. */
static void try_input(const uint8_t *bytes, size_t size) {
    uint8_t *copy = malloc(size + !size);
    if (size) memcpy(copy, bytes, size);
    LLVMFuzzerTestOneInput(copy, size);
    free(copy);
}

static size_t change(brio_rng *rng, uint8_t *bytes, size_t size) {
    static const uint8_t odd[] = {0, 1, 0x7f, 0x80, 0xff, '-', '9', ' '};
    size_t at = brio_rng_below(rng, (uint32_t)size), length = 1 + brio_rng_below(rng, 8);
    if (length > size - at) length = size - at;
    switch (brio_rng_below(rng, 7)) {
    case 0:
        bytes[at] ^= (uint8_t)(1u << brio_rng_below(rng, 8));
        return size;
    case 1:
        memset(bytes + at, odd[brio_rng_below(rng, sizeof odd)], length);
        return size;
    case 2:
        for (size_t i = 0; i < length; i++) bytes[at + i] = (uint8_t)brio_rng_below(rng, 256);
        return size;
    case 3:
        memmove(bytes + at, bytes + at + length, size - at - length);
        return size - length;
    case 4:
        if (size + length > LONGEST) return size;
        memmove(bytes + at + length, bytes + at, size - at);
        return size + length;
    case 5:
        return brio_rng_below(rng, 4) ? size : at;
    default: {
        const seed *other = &seeds[brio_rng_below(rng, (uint32_t)num_seeds)];
        size_t end = other->size < size ? other->size : size;
        if (at < end) memcpy(bytes + at, other->bytes + at, end - at < 4 * length ? end - at : 4 * length);
        return size;
    }
    }
}

int main(int argc, char **argv) {
    static uint8_t bytes[LONGEST];
    size_t inputs = 0;
    brio_rng rng = brio_rng_new(1);
    for (int i = 1; i < argc; i++)
        if (!strcmp(argv[i], "--inputs") && i + 1 < argc)
            inputs = strtoul(argv[++i], NULL, 10);
        else
            add(argv[i]);
    for (size_t i = 0; i < num_seeds; i++) try_input(seeds[i].bytes, seeds[i].size);
    for (size_t i = 0; num_seeds && i < inputs; i++) {
        const seed *s = &seeds[brio_rng_below(&rng, (uint32_t)num_seeds)];
        size_t size = s->size;
        memcpy(bytes, s->bytes, size);
        for (size_t k = 1 + brio_rng_below(&rng, 4); k && size; k--) size = change(&rng, bytes, size);
        try_input(bytes, size);
    }
    for (size_t i = 0; i < num_seeds; i++) free(seeds[i].bytes);
    fprintf(stderr, "%zu files, %zu inputs made of them\n", num_seeds, num_seeds ? inputs : 0);
    return num_seeds ? 0 : 1;
}
