/* A file that the program writes by itself, and that appears only when it is complete: written without a name in the
 * folder of its target, and named at the end. Where the file system has no files without names, it has a temporary name
 * until then. */
#ifndef BRIO_CLI_NEW_FILE_H
#define BRIO_CLI_NEW_FILE_H

#include "cli/run/run.h"
#include "platform/file.h"
#include "platform/target.h"

typedef struct {
    FILE *file; /* NULL if there is none */
    brio_target target;
} new_file;

/** Opens a file for writing. Call cli_new_file_close even if this fails. */
brio_status cli_new_file_open(run *r, const char *path, new_file *out);

/** Flushes the file to the disk and gives it its name. */
brio_status cli_new_file_publish(run *r, const char *path, new_file *f);

/** Frees everything. A file that was not published disappears. */
void cli_new_file_close(new_file *f);

/* --- folders --- */

/** The folder of an output that is an index and many files. It gets its name when all files are complete; the index,
 *  which is published last, names it. So until then an older output of the same name is whole, index and files.
 *
 *  A file `.brio-part` in it, which is locked, says that it is a run's, and what extension its files have. A folder
 *  without that file is the user's, and nothing in it is touched; one whose file nobody has locked is what a killed run
 *  left. */
typedef struct {
    char index[BRIO_PATH_MOST];     /* where the links of the output lead; all other names follow from it */
    char stem[BRIO_PATH_MOST - 64]; /* of the index, without its extension */
    char path[BRIO_PATH_MOST];      /* where the folder is now; "" if there is none */
    int lock;                       /* of its file; -1: none */
    char old[BRIO_PATH_MOST];       /* of the older index; "" if there is none */
    uint32_t num_old;               /* files that the older index names */
    char old_extension[16];         /* of these files, with a dot */
    const char *extension;          /* of the new ones */
    uint32_t most_files;            /* new ones, at most; who knows less than 65,536 sets it after the opening */
    bool marked;                    /* whether the older folder has a mark, since its index is about to go */
    bool json;                      /* whether indexes of this name are JSON, else they are XML */
} new_folder;

/** The extension of an index that is JSON: a virtual point cloud. */
#define CLI_JSON_INDEX ".vpc"

/** How an index of brio begins: JSON, and XML behind the type of its data. By that brio knows those that it wrote. */
#define CLI_JSON_HEAD "{\"type\": \"FeatureCollection\", \"features\": [\n"
#define CLI_XML_HEAD  "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<"

/** Refuses an index that cannot be written or whose folder could not be made: before the work.
 *  index  path of the index, or of a link to it.   extension  of the files: 0.EXT, 1.EXT and so on. */
brio_status cli_new_folder_check(run *r, const char *index, const char *extension);

/** Makes the folder STEM.part. Removes what killed runs left. Call cli_new_folder_close even if this fails. */
brio_status cli_new_folder_open(run *r, const char *index, const char *extension, new_folder *out);

/** Makes the folder OUTPUT.part for one file, 0.rows, that processes write side by side, and that becomes the output.
 *  The output is where its links lead. Call cli_new_folder_close even if this fails. */
brio_status cli_new_folder_open_for(run *r, const char *output, new_folder *out);
/** Refuses an output whose folder could not be made: before the work. */
brio_status cli_new_folder_check_for(run *r, const char *output);
/** Writes the path of that file. */
void cli_new_folder_file(const new_folder *f, char path[BRIO_PATH_MOST + 64]);
/** Makes that file, which was flushed to the disk, the output. Then the folder is closed as one that is not
 *  published. */
brio_status cli_new_folder_adopt(run *r, const new_folder *f, const char *output);

/** Gives the folder its name: STEM, or where that is taken STEM-1, STEM-2 up to 9. Call before the index is written. */
brio_status cli_new_folder_name(run *r, new_folder *f);

/** Ends it.   published  whether the index is: then the files of the older one go, else the new folder does. */
void cli_new_folder_close(new_folder *f, bool published);

/** Write text as that of an attribute of XML, and as that of a string of JSON. */
void cli_write_attribute(FILE *file, const char *text);
void cli_write_text_of_json(FILE *file, const char *text);

#endif
