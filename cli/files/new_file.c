/* Files that appear when they are complete: see new_file.h. */
#include "cli/files/new_file.h"
#include "cli/run/interrupt.h"
#include "platform/disk.h"
#include <errno.h>
#include <string.h>

static brio_status fail(run *r, const char *path) {
    return cli_fail(r, errno == ENOMEM ? BRIO_ERR_NO_MEMORY : BRIO_ERR_WRITE, "%s: %s", path, strerror(errno));
}

brio_status cli_new_file_open(run *r, const char *path, new_file *out) {
    int file = -1;
    *out = (new_file){.target.folder = -1};
    cli_interrupt_writing(true);
    if (brio_target_find(&out->target, path) && brio_target_create(&out->target, &file))
        out->file = brio_stream_of(file);
    if (out->file) return BRIO_OK;
    brio_status status = fail(r, path);
    if (file >= 0) brio_close(file); /* it may be open without the permissions of the old file */
    return status;
}

brio_status cli_new_file_publish(run *r, const char *path, new_file *f) {
    int file = brio_descriptor_of(f->file);
    if (fflush(f->file) != 0 || !brio_flush_to_disk(file)) return fail(r, path);
    if (!brio_target_is_nameless(&f->target)) { /* some systems rename closed files only */
        int closed = fclose(f->file);
        f->file = NULL;
        if (closed != 0) return fail(r, path);
    }
    return brio_target_publish(&f->target, file) ? BRIO_OK : fail(r, path);
}

void cli_new_file_close(new_file *f) {
    if (f->file) fclose(f->file);
    brio_target_close(&f->target);
    cli_interrupt_writing(false);
}
