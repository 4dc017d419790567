/* One thread: locks are no work, and no thread starts. */
#include "platform/thread.h"
#include <time.h>

void brio_mutex_new(brio_mutex *m) {
    (void)m;
}
void brio_mutex_free(brio_mutex *m) {
    (void)m;
}
void brio_mutex_lock(brio_mutex *m) {
    (void)m;
}
void brio_mutex_unlock(brio_mutex *m) {
    (void)m;
}
void brio_condition_new(brio_condition *c) {
    (void)c;
}
void brio_condition_free(brio_condition *c) {
    (void)c;
}
void brio_condition_wait(brio_condition *c, brio_mutex *m) {
    (void)c, (void)m;
}
void brio_condition_wake_all(brio_condition *c) {
    (void)c;
}

bool brio_thread_start(brio_thread *t, void (*work)(void *argument), void *argument, size_t stack) {
    (void)t, (void)work, (void)argument, (void)stack;
    return false;
}
void brio_thread_join(brio_thread *t) {
    (void)t;
}

int brio_processors(void) {
    return 1;
}
long brio_process_number(void) {
    return 1;
}
void brio_yield(void) {}

void brio_sleep(double seconds) {
    double whole = (double)(long)seconds;
    nanosleep(&(struct timespec){(time_t)whole, (long)(1e9 * (seconds - whole))}, NULL);
}

double brio_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
