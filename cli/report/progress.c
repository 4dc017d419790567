/* The progress bar.
 *
 * The time left is estimated from the share that is done and the time it took, beginning anew when the fraction steps
 * back, that is with each call of the library. On a terminal the bar is drawn over itself and erased at the end;
 * elsewhere (--progress into a file or a program) each change is a line. */
#include "cli/report/progress.h"
#include <stdio.h>
#include <string.h>

static void format_time(char text[32], double seconds) {
    long s = seconds < 1e6 ? (long)(seconds + 0.5) : 999999;
    if (s >= 3600)
        snprintf(text, 32, "%ld:%02ld:%02ld left", s / 3600, s / 60 % 60, s % 60);
    else
        snprintf(text, 32, "%ld:%02ld left", s / 60, s % 60);
}

static void draw(progress *bar, double now) {
    enum { WIDTH = 30 };
    static const char full[] = "##############################", empty[] = "------------------------------";
    char left[32] = "";
    double elapsed = now - bar->started;
    if (bar->fraction > 0.01 && elapsed > 0.5) format_time(left, elapsed / bar->fraction * (1 - bar->fraction));
    int done = bar->per_cent * WIDTH / 100;
    fprintf(stderr, "%s%-22s [%.*s%.*s] %3d %%  %s%s", bar->terminal ? "\r" : "", bar->stage, done, full, WIDTH - done,
            empty, bar->per_cent, left, bar->terminal ? "\033[K" : "\n");
    fflush(stderr);
    bar->drawn = true;
    bar->last_drawn = now;
}

void cli_progress_show(progress *bar, const char *stage, double fraction) {
    if (!bar->shown) return;
    double now = cli_clock();
    fraction = fraction > 0 ? fraction < 1 ? fraction : 1 : 0;
    if (fraction < bar->fraction || bar->started == 0) bar->started = now;
    bar->fraction = fraction;
    int per_cent = (int)(100 * fraction);
    bool same = per_cent == bar->per_cent && !strncmp(stage, bar->stage, sizeof bar->stage - 1);
    if (now - bar->last_drawn < 0.1 || (same && bar->drawn)) return;
    bar->per_cent = per_cent;
    snprintf(bar->stage, sizeof bar->stage, "%s", stage);
    draw(bar, now);
}

void cli_progress_end(progress *bar) {
    if (bar->drawn && bar->terminal) fputs("\r\033[K", stderr);
    bar->drawn = false;
}
