/* Calls of the system that fail by plan.
 *
 * A filter of the kernel (seccomp) turns each call into the signal SIGSYS, except those that are made from one instruction
 * here. The handler counts the call, makes it fail, or makes it from that instruction. So every call is seen, whoever makes it:
 * also those within the C library. The handler takes no mask of its own, so that other signals come as without it; the one
 * call that could block SIGSYS is done by hand on the mask that the handler returns to.
 *
 * Processors other than x86-64 have other registers: calls are not seen there. */
#define _GNU_SOURCE
#include "fault.h"
#include <errno.h>
#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <stddef.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#ifndef __x86_64__

bool fault_see_calls(void) {
    return false;
}

#else

enum { MOST_MAPPED = 256 };

typedef enum { NOTHING, DESCRIPTOR, PATH, PATH_AT } file_of;

/* What is known of a call.   interrupts  it may return EINTR.   moves  its third argument is a number of bytes. */
typedef struct {
    int number, class, error;
    file_of file;
    bool interrupts, moves;
} call_row;

static const call_row calls[] = {
    {SYS_open, FAULT_OPEN, EMFILE, PATH, false, false},
    {SYS_openat, FAULT_OPEN, EMFILE, PATH_AT, false, false},
    {SYS_read, FAULT_READ, EIO, DESCRIPTOR, true, true},
    {SYS_pread64, FAULT_READ, EIO, DESCRIPTOR, true, true},
    {SYS_readv, FAULT_READ, EIO, DESCRIPTOR, true, false},
    {SYS_write, FAULT_WRITE, ENOSPC, DESCRIPTOR, true, true},
    {SYS_pwrite64, FAULT_WRITE, ENOSPC, DESCRIPTOR, true, true},
    {SYS_writev, FAULT_WRITE, ENOSPC, DESCRIPTOR, true, false},
    {SYS_fsync, FAULT_WRITE, EIO, DESCRIPTOR, true, false},
    {SYS_fdatasync, FAULT_WRITE, EIO, DESCRIPTOR, true, false},
    {SYS_sync_file_range, FAULT_WRITE, EIO, DESCRIPTOR, false, false},
    {SYS_fallocate, FAULT_WRITE, ENOSPC, DESCRIPTOR, true, false},
    {SYS_ftruncate, FAULT_WRITE, EIO, DESCRIPTOR, true, false},
    {SYS_close, FAULT_WRITE, EIO, DESCRIPTOR, false, false},
    {SYS_rename, FAULT_WRITE, EIO, PATH, false, false},
    {SYS_renameat, FAULT_WRITE, EIO, PATH_AT, false, false},
    {SYS_renameat2, FAULT_WRITE, EIO, PATH_AT, false, false},
    {SYS_linkat, FAULT_WRITE, ENOSPC, PATH_AT, false, false},
    {SYS_fchmod, FAULT_WRITE, EPERM, DESCRIPTOR, false, false},
    {SYS_fchown, FAULT_WRITE, EPERM, DESCRIPTOR, false, false},
    {SYS_mmap, FAULT_MAP, ENOMEM, NOTHING, false, false},
    {SYS_mremap, FAULT_MAP, ENOMEM, NOTHING, false, false},
    {SYS_mprotect, FAULT_MAP, ENOMEM, NOTHING, false, false},
    {SYS_brk, FAULT_MAP, 0, NOTHING, false, false},
    {SYS_stat, FAULT_OTHER, EIO, PATH, false, false},
    {SYS_lstat, FAULT_OTHER, EIO, PATH, false, false},
    {SYS_fstat, FAULT_OTHER, EIO, DESCRIPTOR, false, false},
    {SYS_newfstatat, FAULT_OTHER, EIO, PATH_AT, false, false},
    {SYS_lseek, FAULT_OTHER, EIO, DESCRIPTOR, false, false},
    {SYS_access, FAULT_OTHER, EIO, PATH, false, false},
    {SYS_faccessat, FAULT_OTHER, EIO, PATH_AT, false, false},
    {SYS_faccessat2, FAULT_OTHER, EIO, PATH_AT, false, false},
    {SYS_readlink, FAULT_OTHER, EIO, PATH, false, false},
    {SYS_readlinkat, FAULT_OTHER, EIO, PATH_AT, false, false},
    {SYS_fcntl, FAULT_OTHER, EMFILE, DESCRIPTOR, false, false},
    {SYS_madvise, FAULT_OTHER, EAGAIN, NOTHING, false, false},
    {SYS_fadvise64, FAULT_OTHER, EIO, DESCRIPTOR, false, false},
    {SYS_sched_getaffinity, FAULT_OTHER, EPERM, NOTHING, false, false},
    {SYS_getcwd, FAULT_OTHER, ENOENT, NOTHING, false, false},
    {SYS_poll, 0, 0, DESCRIPTOR, true, false},
};

/* --- the one instruction --- */

extern const char fault_after_call[];
long fault_call(long number, const long *a);

__asm__(".text\n.globl fault_call\n.type fault_call, @function\nfault_call:\n"
        "mov %rdi, %rax\nmov %rsi, %r11\nmov 0(%r11), %rdi\nmov 8(%r11), %rsi\nmov 16(%r11), %rdx\n"
        "mov 24(%r11), %r10\nmov 32(%r11), %r8\nmov 40(%r11), %r9\nsyscall\n"
        ".globl fault_after_call\n.hidden fault_after_call\nfault_after_call:\nret\n");

static long call3(long number, long a, long b, long c) {
    return fault_call(number, (long[6]){a, b, c, 0, 0, 0});
}

/* --- files that are mapped to be shared: scratch files --- */

static int mapped[MOST_MAPPED];
static int num_mapped;

static void note_mapping(long number, const long *a) {
    if (number != SYS_mmap || (a[3] & MAP_TYPE) != MAP_SHARED || a[4] < 0 || num_mapped == MOST_MAPPED) return;
    mapped[num_mapped++] = (int)a[4];
}

static void forget_mapping(long number, const long *a) {
    for (int i = 0; number == SYS_close && i < num_mapped; i++)
        if (mapped[i] == a[0]) mapped[i] = mapped[--num_mapped];
}

static void cut_all(void) {
    for (int i = 0; i < num_mapped; i++) call3(SYS_ftruncate, mapped[i], 0, 0);
}

/* --- what happens to a call --- */

static const call_row *row_of(long number) {
    for (size_t i = 0; i < sizeof calls / sizeof *calls; i++)
        if (calls[i].number == number) return &calls[i];
    return NULL;
}

static void put_number(char *to, long n) {
    char digits[24];
    int length = 0;
    do digits[length++] = (char)('0' + n % 10);
    while (n /= 10);
    while (length) *to++ = digits[--length];
    *to = 0;
}

/* Notes which call failed, of which file. */
static void note_call(const call_row *row, long number, const long *a) {
    char name[64] = "/proc/self/fd/";
    if (fault->struck != 1) return;
    fault->call = number;
    fault->path[0] = 0;
    if (!row) return;
    if (row->file == PATH || row->file == PATH_AT)
        strncpy(fault->path, (const char *)a[row->file == PATH_AT], sizeof fault->path - 1);
    if ((row->file == PATH_AT && !fault->path[0]) || row->file == DESCRIPTOR) {
        put_number(name + strlen(name), a[0]);
        long n = call3(SYS_readlink, (long)name, (long)fault->path, sizeof fault->path - 1);
        fault->path[n > 0 ? n : 0] = 0;
    }
}

static long fail(const call_row *row, long *a) {
    if (row->number == SYS_close) fault_call(SYS_close, a);
    if (row->number == SYS_brk) return call3(SYS_brk, 0, 0, 0); /* where it was */
    return -row->error;
}

static void send_signal(void) {
    uint64_t now[4] = {0}; /* the handler is first */
    fault_call(SYS_rt_sigaction, (long[6]){fault->detail, 0, (long)now, 8, 0, 0});
    fault->caught = now[0] != 0;
    call3(SYS_kill, call3(SYS_getpid, 0, 0, 0), fault->detail, 0);
}

/* Whether a call fails by plan; if so *result is its result. */
static bool fails(const call_row *row, long number, long *a, long *result) {
    switch (fault->kind) {
    case FAULT_ERROR:
        if (!row || !(row->class & fault->detail) || !fault_strikes(FAULT_ERROR)) return false;
        note_call(row, number, a);
        *result = fail(row, a);
        return true;
    case FAULT_INTERRUPT:
        if (!row || !row->interrupts || !fault_strikes(FAULT_INTERRUPT)) return false;
        note_call(row, number, a);
        *result = -EINTR;
        return true;
    case FAULT_SHORT:
        if (!row || !row->moves || a[2] < 2 || !fault_strikes(FAULT_SHORT)) return false;
        note_call(row, number, a);
        a[2] = 1 + a[2] / 3;
        return false;
    default:
        return false;
    }
}

static void before(long number, const long *a) {
    if (fault->kind == FAULT_SIGNAL && fault_strikes(FAULT_SIGNAL)) {
        note_call(row_of(number), number, a);
        send_signal();
    }
    if (fault->kind == FAULT_CUT && num_mapped && fault_strikes(FAULT_CUT)) cut_all();
}

/* --- the handler --- */

static void change_mask(ucontext_t *u, const long *a) {
    uint64_t now, set, sys = (uint64_t)1 << (SIGSYS - 1);
    memcpy(&now, &u->uc_sigmask, 8);
    if (a[2]) memcpy((void *)a[2], &now, 8);
    if (!a[1]) return;
    memcpy(&set, (const void *)a[1], 8);
    now = a[0] == SIG_BLOCK ? now | set : a[0] == SIG_UNBLOCK ? now & ~set : set;
    now &= ~sys;
    memcpy(&u->uc_sigmask, &now, 8);
}

static void on_call(int signal, siginfo_t *info, void *user) {
    ucontext_t *u = user;
    greg_t *g = u->uc_mcontext.gregs;
    long number = info->si_syscall, result = 0;
    long a[6] = {g[REG_RDI], g[REG_RSI], g[REG_RDX], g[REG_R10], g[REG_R8], g[REG_R9]};
    (void)signal;
    if (number == SYS_rt_sigprocmask) {
        change_mask(u, a);
    } else {
        before(number, a);
        if (!fails(row_of(number), number, a, &result)) {
            forget_mapping(number, a);
            note_mapping(number, a);
            result = fault_call(number, a);
        }
    }
    g[REG_RAX] = result;
}

/* Calls that cannot be made from a handler. */
static const int passed[] = {SYS_rt_sigreturn, SYS_clone,  SYS_clone3,         SYS_fork,
                             SYS_vfork,        SYS_execve, SYS_restart_syscall};

enum { PASSED = sizeof passed / sizeof *passed };

static bool install_filter(void) {
    struct sock_filter code[PASSED + 8];
    uint64_t after = (uint64_t)(uintptr_t)fault_after_call;
    const unsigned pointer = offsetof(struct seccomp_data, instruction_pointer);
    size_t n = 0;
    code[n++] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr));
    for (int i = 0; i < PASSED; i++)
        code[n++] =
            (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (unsigned)passed[i], (uint8_t)(PASSED - i + 4), 0);
    code[n++] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, pointer);
    code[n++] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)after, 0, 2);
    code[n++] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, pointer + 4);
    code[n++] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)(after >> 32), 1, 0);
    code[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP);
    code[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    struct sock_fprog program = {(unsigned short)n, code};
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

bool fault_see_calls(void) {
    struct sigaction action = {.sa_sigaction = on_call, .sa_flags = SA_SIGINFO | SA_NODEFER};
    sigemptyset(&action.sa_mask);
    fault->is_on = sigaction(SIGSYS, &action, NULL) == 0 && install_filter();
    return fault->is_on;
}

#endif
