/* What readers of atoms share: see atoms.h. */
#include "io/atoms/atoms.h"
#include "io/number.h"
#include "io/pdb.h"
#include "io/textrow.h"
#include <brio/files.h>
#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

/* --- lines as words --- */

void brio_words_split(char *line, char comment, brio_words *words) {
    char *end = comment ? strchr(line, comment) : NULL;
    if (end) *end = 0;
    words->count = 0;
    for (char *at = brio_skip_blanks(line); *at && words->count < BRIO_MOST_WORDS; at = brio_skip_blanks(at)) {
        words->of[words->count++] = at;
        while (*at && !brio_is_blank(*at)) at++;
        if (*at) *at++ = 0;
    }
}

brio_status brio_words_next(brio_stream *s, char comment, brio_words *words) {
    char *line;
    do {
        words->count = 0;
        BRIO_FORWARD(brio_stream_line(s, &line));
        if (line) brio_words_split(line, comment, words);
    } while (line && !words->count);
    return BRIO_OK;
}

brio_status brio_word_expected(const brio_stream *s, const char *word, const char *what) {
    if (!word)
        return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: line %zu: expected %s, found the end of the line", s->name,
                         s->line, what);
    return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: line %zu: expected %s, found \"%s\"", s->name, s->line, what,
                     brio_excerpt_of(word).text);
}

brio_status brio_word_number(const brio_stream *s, const brio_words *words, size_t i, const char *what, double *value) {
    const char *word = i < words->count ? words->of[i] : NULL, *p = word;
    if (!word || !brio_parse_number(&p, value) || *p || !isfinite(*value)) return brio_word_expected(s, word, what);
    return BRIO_OK;
}

brio_status brio_word_count(const brio_stream *s, const brio_words *words, size_t i, const char *what, uint64_t most,
                            uint64_t *value) {
    const char *word = i < words->count ? words->of[i] : NULL, *p = word;
    if (!word || !brio_parse_count(&p, value) || *p) return brio_word_expected(s, word, what);
    BRIO_EXPECT(s->ctx, *value <= most, BRIO_ERR_FORMAT,
                "%s: line %zu: %s is %" PRIu64 ", expected %" PRIu64 " at most", s->name, s->line, what, *value, most);
    return BRIO_OK;
}

/* --- elements --- */

enum { ATOMIC_NUMBER, RADIUS /* indices of these properties */ };

static bool ends_word(char c) {
    return !c || brio_is_blank(c);
}

int brio_element_of_word(const char *word) {
    const char *end = word;
    uint64_t number;
    if (brio_parse_count(&end, &number)) return ends_word(*end) && number <= BRIO_LAST_ELEMENT ? (int)number : 0;
    size_t letters = 0;
    while (isalpha((unsigned char)word[letters])) letters++;
    if (letters && !ends_word(word[letters]) && !strchr("0123456789_+-", word[letters])) return 0;
    return letters ? brio_element_of(word, letters) : 0;
}

brio_status brio_atoms_plan(brio_builder *b) {
    BRIO_FORWARD(brio_builder_property(b, "atomic_number", BRIO_SCALAR_UINT8));
    return brio_builder_property(b, "radius", BRIO_SCALAR_FLOAT64);
}

void brio_atoms_set_element(brio_builder *b, int element) {
    brio_mesh *m = b->mesh;
    size_t v = m->num_vertices - 1;
    ((uint8_t *)m->properties[ATOMIC_NUMBER].data)[v] = (uint8_t)element;
    ((double *)m->properties[RADIUS].data)[v] = brio_van_der_waals_radius(element);
}

/* --- cells --- */

/* Returns the cosine of an angle in degrees: exactly, where it is a half or 0. */
static double cosine_of(double degrees) {
    if (degrees == 90) return 0;
    if (degrees == 60 || degrees == 120) return degrees == 60 ? 0.5 : -0.5;
    return cos(degrees * (3.14159265358979323846 / 180));
}

bool brio_cell_of_lengths(const double lengths[3], const double angles[3], double cell[9]) {
    for (int k = 0; k < 3; k++)
        if (!(lengths[k] > 0 && isfinite(lengths[k]) && angles[k] > 0 && angles[k] < 180)) return false;
    double alpha = cosine_of(angles[0]), beta = cosine_of(angles[1]), gamma = cosine_of(angles[2]);
    double sine = sqrt((1 - gamma) * (1 + gamma)), y = (alpha - beta * gamma) / sine, z = 1 - beta * beta - y * y;
    if (!(sine > 0) || !(z > 0)) return false;
    const double rows[9] = {
        lengths[0],          0, 0, lengths[1] * gamma, lengths[1] * sine, 0, lengths[2] * beta, lengths[2] * y,
        lengths[2] * sqrt(z)};
    memcpy(cell, rows, sizeof rows);
    return true;
}

double brio_cell_volume(const double cell[9]) {
    const double *a = cell, *b = cell + 3, *c = cell + 6;
    return fabs(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                a[2] * (b[0] * c[1] - b[1] * c[0]));
}

void brio_cell_position(const double cell[9], const double fraction[3], double x[3]) {
    const double f[3] = {fraction[0], fraction[1], fraction[2]};
    for (int k = 0; k < 3; k++) x[k] = f[0] * cell[k] + f[1] * cell[3 + k] + f[2] * cell[6 + k];
}

bool brio_is_p1(const char *group) {
    char letters[4] = "";
    size_t count = 0;
    for (; *group; group++) {
        if (strchr(" _'\"\t", *group)) continue;
        if (count == 3) return false;
        letters[count++] = (char)toupper((unsigned char)*group);
    }
    return !count || !strcmp(letters, "P1");
}

brio_status brio_cell_keep(brio_builder *b, const double cell[9], const bool periodic[3]) {
    char text[9 * (BRIO_NUMBER_LENGTH + 1)], letters[8] = "";
    size_t length = 0, directions = 0, vectors = 0;
    for (int k = 0; k < 3; k++) {
        bool is_vector = cell[3 * k] != 0 || cell[3 * k + 1] != 0 || cell[3 * k + 2] != 0;
        vectors += is_vector;
        if (is_vector && periodic[k]) letters[directions++] = "xyz"[k];
    }
    if (!vectors) return BRIO_OK;
    if (!directions) strcpy(letters, "none"), directions = 4;
    for (int i = 0; i < 9; i++) {
        if (i) text[length++] = ' ';
        length += brio_print_double(text + length, cell[i]);
    }
    BRIO_FORWARD(brio_mesh_set_metadata(b->mesh, "cell.vectors", text, length));
    return brio_mesh_set_metadata(b->mesh, "cell.periodic", letters, directions);
}

int brio_mesh_cell(const brio_mesh *mesh, double cell[9], int open[3]) {
    const brio_metadata *vectors = brio_mesh_metadata(mesh, "cell.vectors"),
                        *letters = brio_mesh_metadata(mesh, "cell.periodic");
    const char *at = vectors ? vectors->bytes : "";
    double numbers[9];
    for (int i = 0; i < 9; i++) {
        while (brio_is_blank(*at)) at++;
        if (!brio_parse_number(&at, &numbers[i]) || !isfinite(numbers[i])) return 0;
    }
    memcpy(cell, numbers, sizeof numbers);
    for (int k = 0; k < 3; k++) open[k] = letters && !strchr(letters->bytes, "xyz"[k]);
    return 1;
}
