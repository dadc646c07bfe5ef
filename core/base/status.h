/* status.h - how every fallible function of sinew says what went wrong.
 *
 * A fallible function returns sn_status (0 = SN_OK) and takes the caller's sn_error last. The message says
 * where, what was found and what was wanted. The library never prints, exits or keeps a "last error" of its
 * own. */
#ifndef SN_BASE_STATUS_H
#define SN_BASE_STATUS_H

#ifdef __cplusplus /* every header that C++ code may include wraps its functions in these */
#define SN_BEGIN_DECLS extern "C" {
#define SN_END_DECLS }
#else
#define SN_BEGIN_DECLS
#define SN_END_DECLS
#endif

#if defined(__GNUC__)
#define SN_MUST_USE __attribute__((warn_unused_result))
#define SN_PRINTF(fmt, args) __attribute__((format(printf, fmt, args)))
#else
#define SN_MUST_USE
#define SN_PRINTF(fmt, args)
#endif

typedef enum sn_status {
    SN_OK = 0,
    SN_EINVAL,   /* an argument or a value that a caller gave                          */
    SN_ENOMEM,   /* memory                                                             */
    SN_EIO,      /* a file that cannot be opened, read or written                      */
    SN_EFORMAT,  /* a file whose contents are wrong                                    */
    SN_EMESH,    /* geometry that cannot be meshed, or a mesher that failed            */
    SN_ESOLVE,   /* a linear system that cannot be solved                              */
    SN_ERENDER,  /* no OpenGL context, or a picture that cannot be made                */
    SN_ELIMIT,   /* a time, memory or size limit                                       */
    SN_ECANCEL,  /* interrupted                                                        */
    SN_EINTERNAL /* a promise of our own that did not hold: a bug                      */
} sn_status;

typedef struct sn_error {
    sn_status code;
    char msg[512]; /* one line, no final newline, always 0-terminated */
} sn_error;

SN_BEGIN_DECLS

/* Fills *err (NULL allowed) and returns code, so that `return sn_fail(err, SN_EINVAL, "...")` reads well. */
sn_status sn_fail(sn_error *err, sn_status code, const char *fmt, ...) SN_PRINTF(3, 4);

/* Puts text before the message that *err already holds ("bone 'femur': " + ...). Returns err->code. */
sn_status sn_fail_prefix(sn_error *err, sn_status code, const char *fmt, ...) SN_PRINTF(3, 4);

SN_END_DECLS

#endif
