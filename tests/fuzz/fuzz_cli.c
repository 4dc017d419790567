/* The program's command lines: main itself, called with words that the input chooses from the tables of commands and options,
 * good and hostile values, and files that are right or spoilt. It ends with one of its exit codes, and never with that of a
 * fault. What it prints goes nowhere. */
#include "cli/run/commands.h"
#include "fuzz.h"
#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_WORDS = 24, MOST_TEXT = 40 };
enum { LAST_CODE = 6, INTERRUPTED = 130 }; /* exit codes, of `brio help` */

int brio_cli_main(int argc, char **argv);

static const char *const values[] = {
    "0",   "1",    "2",     "3",   "-1",    "0.5",         "7",  "1e400",
    "nan", "",     "x,y,z", "abc", "inner", "a,b",         "xy", "18446744073709551616",
    "0x2", "1.5G", "1e-9",  "all", "w",     "-2147483649", "-",  "5 5"};
static const char *const files[] = {"points.xyz", "mesh.ply", "weights.csv", "tets.node", "empty.xyz", "atoms.pdb",
                                    "spoilt.ply", "flat.xyz", "missing.ply", ".",         "out.ply",   "out.xyz",
                                    "out.vtu",    "out.node", "out.csv",     "out.npy",   "out.las",   "out.obj",
                                    "no/out.ply", "out.what", "mesh.obj"};

enum { VALUES = sizeof values / sizeof *values, FILES = sizeof files / sizeof *files };

/* --- a folder of files --- */

static void put(const char *name, const char *text) {
    FILE *f = fopen(name, "w");
    FUZZ_EXPECT(f && fputs(text, f) >= 0 && fclose(f) == 0, "%s", name);
}

static void put_points(const char *name, int flat) {
    FILE *f = fopen(name, "w");
    FUZZ_EXPECT(f, "%s", name);
    for (int i = 0; i < 60; i++) {
        double z = (2 * i + 1) / 60.0 - 1, a = 2.4 * i, r = sqrt(1 - z * z);
        fprintf(f, "%.6f %.6f %.6f\n", r * cos(a), r * sin(a), flat ? 0 : z);
    }
    fclose(f);
}

static const char *const tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

static void put_files(void) {
    put_points("points.xyz", 0), put_points("flat.xyz", 1);
    put("mesh.obj", tetrahedron);
    put("mesh.ply", "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
                    "element face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
                    "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
    put("weights.csv", "x,y,z,w\n0,0,0,1\n1,0,0,0\n0,1,0,2\n0,0,1,0\n1,1,1,0.5\n2,1,0,1\n");
    put("tets.node", "5 3 1 0\n1 0 0 0 5\n2 1 0 0 6\n3 0 1 0 7\n4 0 0 1 8\n5 1 1 1 9\n");
    put("tets.ele", "2 4 0\n1 1 2 3 4\n2 2 3 4 5\n");
    put("empty.xyz", "");
    put("atoms.pdb", "ATOM      1  C   ALA A   1       0.000   0.000   0.000  1.00  0.00           C\n"
                     "ATOM      2  O   ALA A   1       1.200   0.300   0.000  1.00  0.00           O\n");
    put("spoilt.ply", "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nend_header\n1\n");
}

static char folder[64];
static FILE *nowhere;

static void empty_folder(void) {
    DIR *dir = opendir(".");
    for (struct dirent *e = dir ? readdir(dir) : NULL; e; e = readdir(dir))
        if (e->d_name[0] != '.') unlink(e->d_name);
    if (dir) closedir(dir);
    FUZZ_EXPECT(chdir("/") == 0);
    rmdir(folder);
}

static void begin(void) {
    snprintf(folder, sizeof folder, "%s/brio-fuzz-XXXXXX", access("/dev/shm", W_OK) ? "/tmp" : "/dev/shm");
    FUZZ_EXPECT(mkdtemp(folder) && chdir(folder) == 0, "%s", folder);
    atexit(empty_folder);
    nowhere = fopen("/dev/null", "r+");
    FUZZ_EXPECT(nowhere && dup2(fileno(nowhere), 0) == 0 && dup2(fileno(nowhere), 1) == 1);
}

/* --- words --- */

typedef struct {
    char *word[MOST_WORDS + 8];
    char text[MOST_WORDS][MOST_TEXT];
    int count, texts;
} line;

static void add(line *l, const char *word) {
    if (l->count < MOST_WORDS) l->word[l->count++] = (char *)word;
}

static char *new_text(line *l) {
    return l->text[l->texts < MOST_WORDS - 1 ? l->texts++ : l->texts];
}

/* Bytes as a word; no path leads out of the folder. */
static const char *any_word(fuzz_input *in, line *l) {
    char *text = new_text(l);
    size_t length = fuzz_below(in, 12);
    for (size_t i = 0; i < length; i++) {
        text[i] = (char)(1 + fuzz_byte(in) % 127);
        if (text[i] == '/' || text[i] == '.' || (text[i] >= '4' && text[i] <= '9')) text[i] = '3';
    }
    text[length < 4 ? length : 4] = 0; /* short, so that no number is large */
    return text;
}

static size_t count_rows(const option *rows) {
    size_t n = 0;
    while (rows[n].kind != OPTION_END) n++;
    return n;
}

static const char *any_choice(fuzz_input *in, const option_choice *choices) {
    size_t n = 0;
    while (choices[n].name) n++;
    return n ? choices[fuzz_below(in, n)].name : "";
}

static const char *value_for(fuzz_input *in, line *l, const option *o) {
    size_t kind = fuzz_below(in, 8);
    if (kind == 0) return any_word(in, l);
    if (o->choices && kind < 6) return any_choice(in, o->choices);
    bool file = o->kind == OPTION_INPUT || o->kind == OPTION_OUTPUT || o->kind == OPTION_TEXT;
    return file && kind < 6 ? files[fuzz_below(in, FILES)] : values[fuzz_below(in, VALUES)];
}

static void add_option(fuzz_input *in, line *l, const option *rows) {
    size_t n = count_rows(rows);
    const option *o = n ? &rows[fuzz_below(in, n)] : NULL;
    if (!o || o->kind == OPTION_TITLE || o->kind == OPTION_NOTE || !strcmp(o->name, "scratch")) return;
    char *text = new_text(l);
    bool joined = fuzz_byte(in) < 40;
    if (o->letter && fuzz_flag(in))
        snprintf(text, MOST_TEXT, "-%c", o->letter);
    else
        snprintf(text, MOST_TEXT, "--%s", o->name);
    if (joined) snprintf(text + strlen(text), MOST_TEXT - strlen(text), "=%s", value_for(in, l, o));
    add(l, text);
    if (o->kind != OPTION_FLAG && !joined) add(l, value_for(in, l, o));
}

static void make_line(fuzz_input *in, line *l) {
    size_t n = 0, words = 1 + fuzz_below(in, 8);
    while (cli_commands[n]) n++;
    memset(l, 0, sizeof *l);
    add(l, "brio");
    const command *c = cli_commands[fuzz_below(in, n)];
    size_t first = fuzz_byte(in);
    add(l, first < 240 ? c->name : first < 248 ? "help" : any_word(in, l));
    if (first < 240 && !strcmp(c->name, "generate")) /* of few points, if not said otherwise */
        add(l, "-n"), add(l, "30"), add(l, "--resolution"), add(l, "8"), add(l, "--truth-resolution"), add(l, "8");
    for (size_t i = 0; i < words; i++) switch (fuzz_below(in, 8)) {
        case 0:
        case 1:
        case 2:
            add(l, files[fuzz_below(in, FILES)]);
            break;
        case 3:
            add_option(in, l, cli_common_options);
            break;
        case 4:
            add(l, c->choices ? any_choice(in, c->choices) : any_word(in, l));
            break;
        default:
            if (c->options) add_option(in, l, c->options);
        }
    for (int i = l->count; i < MOST_WORDS + 8; i++) l->word[i] = NULL;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    static line l;
    fuzz_input in = {bytes, size};
    FILE *output = stdout, *errors = stderr;
    if (!nowhere) begin();
    put_files();
    make_line(&in, &l);
    stdout = stderr = nowhere;
    int code = brio_cli_main(l.count, l.word);
    stdout = output, stderr = errors;
    FUZZ_EXPECT((code >= 0 && code <= LAST_CODE) || code == INTERRUPTED, "exit code %d", code);
    return 0;
}
