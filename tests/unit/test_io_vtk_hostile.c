/* VTU and VTP files that lie: sizes, offsets, blocks, indices, and a bomb. */
#include "vtk_ways.h"

/* A VTP file of one piece with `points` points, whose array of points has these attributes and this content. */
static void expect_points_error(const char *points, const char *attributes, const char *content, const char *part) {
    char text[2048];
    snprintf(text, sizeof text,
             VTP_TAG "><PolyData><Piece NumberOfPoints=\"%s\"><Points><DataArray type=\"Float32\" "
                     "NumberOfComponents=\"3\" %s>%s</DataArray></Points></Piece></PolyData></VTKFile>",
             points, attributes, content);
    io_expect_error("l.vtp", text, BRIO_ERR_FORMAT, part);
}

static void errors_of_tags(void) {
    io_expect_error("a.vtu", "", BRIO_ERR_FORMAT, "a tag VTKFile");
    io_expect_error("a.vtu", "<?xml version=\"1.0\"?><VTKFile type=\"ImageData\">", BRIO_ERR_FORMAT,
                    "UnstructuredGrid or PolyData");
    io_expect_error("a.vtu", "<VTKFile type=\"PolyData\" byte_order=\"Middle\">", BRIO_ERR_FORMAT, "byte_order");
    io_expect_error("a.vtu",
                    VTU_TAG " compressor=\"vtkLZ4DataCompressor\"><Piece NumberOfPoints=\"1\" "
                            "NumberOfCells=\"0\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" "
                            "format=\"binary\">AAAA</DataArray>",
                    BRIO_ERR_FORMAT, "compressed by vtkLZ4DataCompressor");
    io_expect_error("a.vtu", VTU_TAG "><Piece NumberOfPoints=\"x\" NumberOfCells=\"0\">", BRIO_ERR_FORMAT,
                    "a number NumberOfPoints, found \"x\"");
    io_expect_error("a.vtu", VTU_TAG "><Piece NumberOfPoints=\"1\">", BRIO_ERR_FORMAT, "a number NumberOfCells");
    io_expect_error("a.vtu", VTU_TAG "><Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"/>", BRIO_ERR_FORMAT,
                    "a tag /VTKFile");
    io_expect_error("a.vtu", VTU_TAG "></VTKFile>", BRIO_ERR_FORMAT, "no Piece");
    io_expect_error("a.vtu", VTU_TAG "><Piece NumberOfPoints=\"1\" NumberOfCells=\"0\"/></VTKFile>", BRIO_ERR_FORMAT,
                    "no array of points");
    expect_points_error("1", "format=\"hex\"", "", "appended, binary or ascii");
    expect_points_error("1", "format=\"appended\" offset=\"0\"", "", "a tag AppendedData");
    expect_points_error("18446744073709551615", "format=\"ascii\"", "1 2 3", "a number NumberOfPoints, found");
}

static void errors_of_text(void) {
    expect_points_error("1", "format=\"ascii\"", "1 2 x", "found \"x\"");
    expect_points_error("1", "format=\"ascii\"", "1 2", "rows");
    expect_points_error("2", "format=\"ascii\"", "1 2 3", "has 1 rows, not 2");
    expect_points_error("1", "format=\"ascii\"", "1 2 3 4 5 6", "has 2 or more rows, not 1");
    expect_points_error("1", "format=\"ascii\"/", "", "has 0 rows, not 1");
    io_expect_error("a.vtp",
                    VTP_TAG "><Piece NumberOfPoints=\"1\"><PointData><DataArray Name=\"a\" type=\"UInt8\" "
                            "format=\"ascii\">256</DataArray>",
                    BRIO_ERR_FORMAT, "a number of type UInt8");
    io_expect_error("a.vtp",
                    VTP_TAG "><Piece NumberOfPoints=\"1\"><PointData><DataArray Name=\"a\" type=\"Int64\" "
                            "format=\"ascii\">9223372036854775808</DataArray>",
                    BRIO_ERR_FORMAT, "type Int64");
}

static void errors_of_base64(void) {
    expect_points_error("1", "format=\"binary\"", "DAAA*AAA", "expected base64");
    expect_points_error("1", "format=\"binary\"", "D=AAAAAA", "expected base64");
    expect_points_error("1", "format=\"binary\"", "", "expected base64");
    expect_points_error("1", "format=\"binary\"", "DAAAAAAAAAAAAIA/", "expected base64");
    expect_points_error("1", "format=\"binary\"", "DQAAAAAAAAAAAIA/AAAAQAAAQEA=", "13 bytes");
    expect_points_error("2", "format=\"binary\"", "DAAAAAAAAAAAAIA/AAAAQAAAQEA=", "not the number of rows of 12");
    expect_points_error("1", "format=\"binary\"",
                        "////////////AIA/AAAAQAAAQEA=", "promises 18446744073709551615 bytes");
}

/* Files whose data are appended raw: `words` numbers of 64 bits. */
static void expect_appended_error(const char *attributes, const char *offset, const uint64_t *words, size_t count,
                                  const char *part) {
    char text[1024];
    int size = snprintf(text, sizeof text,
                        VTP_TAG "%s><PolyData><Piece NumberOfPoints=\"1\"><Points><DataArray type=\"Float64\" "
                                "NumberOfComponents=\"3\" format=\"appended\" offset=\"%s\"/></Points></Piece>"
                                "</PolyData><AppendedData encoding=\"raw\">_",
                        attributes, offset);
    brio_status status;
    memcpy(text + size, words, count * sizeof *words);
    brio_mesh *m = io_read_bytes("l.vtp", text, (size_t)size + count * sizeof *words, &status);
    EXPECT(status == BRIO_ERR_FORMAT && strstr(brio_message(io_ctx), part), "\"%s\" without \"%s\"",
           brio_message(io_ctx), part);
    brio_mesh_free(m);
}

static void errors_of_appended_arrays(void) {
    static const char *const zlib = " compressor=\"vtkZLibDataCompressor\"";
    const uint64_t right[] = {24, 0, 0, 0}, most = UINT64_MAX;
    expect_appended_error("", "0", right, 3, "promises 24 bytes, the file has at most 16");
    expect_appended_error("", "0", right, 0, "ends at byte");
    expect_appended_error("", "9", right, 4, "bytes");
    expect_appended_error("", "1000", right, 4, "beyond the end of the file");
    expect_appended_error("", "9223372036854775807", right, 4, "beyond the end of the file");
    expect_appended_error("", "9223372036854775808", right, 4, "a number offset");
    expect_appended_error("", "99999999999999999999", right, 4, "a number offset");
    expect_appended_error("", "0", &most, 1, "promises 18446744073709551615 bytes");
    if (num_ways() < NUM_WAYS) return;
    const uint64_t many[] = {UINT64_MAX, 1, 1, 1}, huge[] = {2, UINT64_C(1) << 63, 0, 1, 1, 0};
    const uint64_t large[] = {1, 24, 0, UINT64_MAX, 0}, sum[] = {2, 12, 0, UINT64_C(1) << 63, UINT64_C(1) << 63};
    const uint64_t bomb[] = {1, UINT64_C(1) << 40, 0, 8, 0}, wrong[] = {1, 24, 0, 8, 0x1234567890abcdef};
    const uint64_t empty[] = {1, 24, 0, 0}, none[] = {0, 24, 0};
    expect_appended_error(zlib, "0", many, 4, "promises 18446744073709551615 bytes");
    expect_appended_error(zlib, "0", huge, 6, "which are not in");
    expect_appended_error(zlib, "0", large, 5, "promises 18446744073709551615 bytes");
    expect_appended_error(zlib, "0", sum, 5, "over 2^64");
    expect_appended_error(zlib, "0", bomb, 5, "which are not in 8 compressed bytes");
    expect_appended_error(zlib, "0", wrong, 5, "zlib cannot inflate");
    expect_appended_error(zlib, "0", empty, 4, "which are not in 0 compressed bytes");
    expect_appended_error(zlib, "0", none, 3, "has 0 bytes");
}

/* A stream of zlib that stores n bytes as they are; returns its size. */
static size_t store_block(const uint8_t *bytes, size_t n, uint8_t *out) {
    uint32_t a = 1, b = 0;
    const uint8_t head[] = {0x78, 1, 1, (uint8_t)n, 0, (uint8_t)~n, 0xff};
    memcpy(out, head, sizeof head);
    memcpy(out + sizeof head, bytes, n);
    for (size_t i = 0; i < n; i++) b += a += bytes[i];
    const uint8_t tail[] = {(uint8_t)(b >> 8), (uint8_t)b, (uint8_t)(a >> 8), (uint8_t)a};
    memcpy(out + sizeof head + n, tail, sizeof tail);
    return sizeof head + n + sizeof tail;
}

/* A compressed array of one point in blocks of `stored` bytes, which are said to be `block` bytes of `extra` bytes more in
 * the file. */
static void expect_blocks(size_t stored, uint64_t block, uint64_t extra, const char *part) {
    uint64_t words[32] = {24 / stored, block, 0};
    const double point[] = {1, 2, 3};
    uint8_t *at = (uint8_t *)(words + 3 + words[0]);
    for (uint64_t i = 0; i < words[0]; i++) {
        size_t size = store_block((const uint8_t *)point + i * stored, stored, at);
        words[3 + i] = size + extra;
        at += size + extra;
    }
    if (part) {
        expect_appended_error(" compressor=\"vtkZLibDataCompressor\"", "0", words, 24, part);
        return;
    }
    char text[1024];
    brio_status status;
    int size = snprintf(text, sizeof text,
                        VTP_TAG " compressor=\"vtkZLibDataCompressor\"><PolyData><Piece NumberOfPoints=\"1\"><Points>"
                                "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"appended\" "
                                "offset=\"0\"/></Points></Piece></PolyData><AppendedData encoding=\"raw\">_");
    memcpy(text + size, words, sizeof words);
    brio_mesh *m = io_read_bytes("b.vtp", text, (size_t)size + sizeof words, &status);
    EXPECT(m && m->vertices[0] == 1 && m->vertices[2] == 3, "%s", brio_message(io_ctx));
    brio_mesh_free(m);
}

/* Blocks that inflate to more or to less than their sizes say, or that end before the next one begins. */
static void sizes_of_blocks_are_held_against_the_bytes(void) {
    if (num_ways() < NUM_WAYS) return;
    expect_blocks(24, 24, 0, NULL);
    expect_blocks(6, 6, 0, NULL); /* coordinates that two blocks share */
    expect_blocks(12, 12, 3, "ends before its size says");
    expect_blocks(12, 24, 0, "bytes");
    expect_blocks(8, 8, (uint64_t)0 - 1, "does not end where its size says");
    const uint64_t short_block[] = {1, 24, 0, 19, 0, 0, 0}, long_block[] = {1, 24, 0, 43, 0, 0, 0, 0, 0, 0};
    uint64_t words[10];
    const uint8_t zeros[32] = {0};
    memcpy(words, short_block, sizeof short_block);
    store_block(zeros, 8, (uint8_t *)(words + 4));
    expect_appended_error(" compressor=\"vtkZLibDataCompressor\"", "0", words, 7, "ends before its size says");
    memcpy(words, long_block, sizeof long_block);
    store_block(zeros, 32, (uint8_t *)(words + 4));
    expect_appended_error(" compressor=\"vtkZLibDataCompressor\"", "0", words, 10, "more bytes than its size says");
}

/* Two arrays at one place, and cells that lie. */
static void errors_of_cells(void) {
#define CELLS(connectivity, offsets)                                                                                   \
    VTU_TAG "><Piece NumberOfPoints=\"3\" NumberOfCells=\"1\"><Points><DataArray type=\"Int8\" "                       \
            "NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0</DataArray></Points><Cells><DataArray "       \
            "type=\"Int64\" Name=\"connectivity\" format=\"ascii\">" connectivity "</DataArray><DataArray "            \
            "type=\"Int64\" Name=\"offsets\" format=\"ascii\">" offsets "</DataArray><DataArray type=\"UInt8\" "       \
            "Name=\"types\" format=\"ascii\">5</DataArray></Cells></Piece></VTKFile>"
    io_expect_error("a.vtu", CELLS("0 1 3", "3"), BRIO_ERR_FORMAT, "point 3, expected one of the 3");
    io_expect_error("a.vtu", CELLS("0 1 -1", "3"), BRIO_ERR_FORMAT, "point -1");
    io_expect_error("a.vtu", CELLS("0 1 9223372036854775807", "3"), BRIO_ERR_FORMAT, "point 9.223372036854");
    io_expect_error("a.vtu", CELLS("0 1 2", "4"), BRIO_ERR_FORMAT, "offset 4, expected 0 to 3");
    io_expect_error("a.vtu", CELLS("0 1 2", "-1"), BRIO_ERR_FORMAT, "offset -1");
    io_expect_error("a.vtu", CELLS("0 1 2", "2"), BRIO_ERR_FORMAT, "2 corners, expected 3");
    io_expect_error("a.vtu", CELLS("0 1 2", "3 4"), BRIO_ERR_FORMAT, "has 2 or more rows, not 1");
#undef CELLS
#define POLYHEDRON(faces, end)                                                                                         \
    VTU_TAG "><Piece NumberOfPoints=\"3\" NumberOfCells=\"1\"><Points><DataArray type=\"Int8\" "                       \
            "NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0</DataArray></Points><Cells><DataArray "       \
            "type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray><DataArray type=\"Int64\" "        \
            "Name=\"offsets\" format=\"ascii\">3</DataArray><DataArray type=\"UInt8\" Name=\"types\" "                 \
            "format=\"ascii\">42</DataArray><DataArray type=\"Int64\" Name=\"faces\" format=\"ascii\">" faces          \
            "</DataArray><DataArray type=\"Int64\" Name=\"faceoffsets\" format=\"ascii\">" end                         \
            "</DataArray></Cells></Piece></VTKFile>"
    io_expect_error("a.vtu", POLYHEDRON("1 3 0 1 3", "5"), BRIO_ERR_FORMAT, "point 3, expected one of the 3");
    io_expect_error("a.vtu", POLYHEDRON("1 4 0 1 2", "5"), BRIO_ERR_FORMAT, "numbers in the array faces");
    io_expect_error("a.vtu", POLYHEDRON("2 3 0 1 2", "5"), BRIO_ERR_FORMAT, "numbers in the array faces");
    io_expect_error("a.vtu", POLYHEDRON("1 -3 0 1 2", "5"), BRIO_ERR_FORMAT, "numbers in the array faces");
    io_expect_error("a.vtu", POLYHEDRON("1 3 0 1 2", "6"), BRIO_ERR_FORMAT, "face offset 6, expected 0 to 5");
    io_expect_error("a.vtu", POLYHEDRON("1 3 0 1 2", "-1"), BRIO_ERR_FORMAT, "face offset -1");
#undef POLYHEDRON
    io_expect_error("a.vtp",
                    VTP_TAG "><Piece NumberOfPoints=\"0\"><PointData><DataArray type=\"Int8\" Name=\"a\" "
                            "format=\"appended\" offset=\"0\"/><DataArray type=\"Int8\" Name=\"b\" "
                            "format=\"appended\" offset=\"0\"/></PointData></Piece><AppendedData encoding=\"base64\">"
                            "_AAAAAAAAAAA=</AppendedData></VTKFile>",
                    BRIO_ERR_FORMAT, "where another one is");
}

/* A small file of a large array of zeros, against the memory limit. */
static void bomb_is_held_against_the_limit(void) {
    enum { POINTS = 2000000 };
    const uint32_t triangle[] = {0, 1, 2};
    struct stat facts;
    brio_mesh *mesh = NULL, *back = NULL;
    brio_write_options options = options_of(PACKED);
    if (num_ways() < NUM_WAYS) return;
    EXPECT(brio_mesh_new(io_ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, NULL, POINTS) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(mesh, (const uint64_t[]){0, 3}, triangle, 1) == BRIO_OK);
    EXPECT(brio_write(io_ctx, io_path("bomb.vtp"), mesh, &options) == BRIO_OK, "%s", brio_message(io_ctx));
    brio_mesh_free(mesh);
    EXPECT(stat(io_path("bomb.vtp"), &facts) == 0 && facts.st_size < 100000, "%zu bytes", (size_t)facts.st_size);
    brio_context_set_memory_limit(io_ctx, 8 << 20);
    EXPECT(brio_read(io_ctx, io_path("bomb.vtp"), NULL, &back) == BRIO_ERR_NO_MEMORY && !back);
    brio_context_set_memory_limit(io_ctx, 0);
    EXPECT(brio_read(io_ctx, io_path("bomb.vtp"), NULL, &back) == BRIO_OK, "%s", brio_message(io_ctx));
    EXPECT(back && back->num_vertices == POINTS && back->vertices[3 * POINTS - 1] == 0);
    brio_mesh_free(back);
}

/* The greatest number stood for a number that is not known: then offsets were read behind the end of their array. */
static void as_many_cells_as_no_array_has_are_refused(void) {
    io_expect_error("a.vtp",
                    VTP_TAG
                    "><PolyData><Piece NumberOfPoints=\"3\" NumberOfPolys=\"18446744073709551615\"><Points><DataArray "
                    "type=\"Int8\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0</DataArray></Points>"
                    "<Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray>"
                    "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray></Polys></Piece>"
                    "</PolyData></VTKFile>",
                    BRIO_ERR_FORMAT, "a number NumberOfPolys, found \"18446744073709551615\"");
}

static const char legacy_text[] =
    "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\n"
    "LINES 1 3\n2 0 1\nPOINT_DATA 3\nSCALARS a%20b short\nLOOKUP_TABLE t\n1 2 3\nFIELD f 1\nlabel 1 3 "
    "string\na\nb\nc\n";

#define TEXT(text)                                                                                                     \
    { text, sizeof text - 1 }

/* A grid in binary, with what is passed over: texts with their lengths, and bits. */
static size_t make_legacy(char *to) {
    static const char start[] = "# vtk DataFile Version 5.1\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 float\n";
    static const uint8_t points[36] = {[12] = 0x3f, [13] = 0x80, [28] = 0x3f, [29] = 0x80};
    static const uint8_t offsets[16] = {[15] = 3}, corners[24] = {[15] = 1, [23] = 2}, types[4] = {[3] = 5};
    const struct {
        const void *bytes;
        size_t size;
    } parts[] = {{start, sizeof start - 1},
                 {points, sizeof points},
                 TEXT("\nCELLS 2 3\nOFFSETS vtktypeint64\n"),
                 {offsets, sizeof offsets},
                 TEXT("\nCONNECTIVITY vtktypeint64\n"),
                 {corners, sizeof corners},
                 TEXT("\nCELL_TYPES 1\n"),
                 {types, sizeof types},
                 TEXT("\nPOINT_DATA 3\nFIELD f 2\nlabel 1 3 string\n"),
                 TEXT("\xc1x\xc2yz\xc0\n"),
                 TEXT("on 1 3 bit\n\xa0\n")};
    size_t size = 0;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        memcpy(to + size, parts[i].bytes, parts[i].size);
        size += parts[i].size;
    }
    return size;
}

static void every_prefix_and_changed_byte_of_legacy_files(void) {
    uint64_t state = 5;
    for (int k = 0; k < 2; k++) {
        char bytes[1024];
        size_t size = k ? make_legacy(bytes) : sizeof legacy_text - 1;
        if (!k) memcpy(bytes, legacy_text, size);
        brio_mesh *m = io_expect_sane("a.vtk", bytes, size, "whole", 0);
        EXPECT(m && m->num_vertices == 3 && m->num_faces == 1, "form %d", k);
        brio_mesh_free(m);
        for (size_t n = 0; n < size; n++) brio_mesh_free(io_expect_sane("a.vtk", bytes, n, "prefix", n));
        for (size_t i = 0; i < 8 * size; i++) {
            char old = bytes[i / 8];
            bytes[i / 8] = i % 2 ? (char)(old ^ 1 << io_random(&state) % 8) : (char)io_random(&state);
            brio_mesh_free(io_expect_sane("a.vtk", bytes, size, "byte", i));
            bytes[i / 8] = old;
        }
    }
}

SUITE(test_io_vtk_hostile) {
    io_begin();
    RUN(errors_of_tags);
    RUN(errors_of_text);
    RUN(errors_of_base64);
    RUN(errors_of_appended_arrays);
    RUN(sizes_of_blocks_are_held_against_the_bytes);
    RUN(errors_of_cells);
    RUN(as_many_cells_as_no_array_has_are_refused);
    RUN(bomb_is_held_against_the_limit);
    RUN(every_prefix_and_changed_byte_of_legacy_files);
    return io_end();
}
