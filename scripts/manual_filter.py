"""manual_filter.py HEADER: the header as Doxygen is to read it. Its comments have columns, which stay as they are; the first sentence
is the brief one. Comments of /* behind a declaration or a member are those of that, too."""

import re
import sys

text = open(sys.argv[1], encoding="utf-8").read()


def documented(found):
    lines = [re.sub(r"^\s*\* ?", "", line) for line in found[1].strip().split("\n")]
    body = "\n".join(lines)
    sentence = re.split(r"(?<=[.:])\s", " ".join(body.split("\n\n")[0].split()), maxsplit=1)[0]
    brief = re.sub(r"([#@\\<>&%])", r"\\\1", sentence)
    # as many lines as before, so that line numbers stay
    return "/** %s\\verbatim %s \\endverbatim */" % (brief + "\n\n" if len(lines) > 1 else "", body) if len(lines) > 1 else "/** %s */" % brief


def page(found):
    body = "\n".join(re.sub(r"^ \* ?", "", line) for line in found[1].strip().split("\n"))
    command = "\\mainpage brio.h" if body.startswith("brio.h") else "\\file"
    return "/** %s\n\\verbatim %s \\endverbatim */" % (command, body)


text = re.sub(r"(?s)\A/\*(.*?)\*/", page, text)
text = re.sub(r"(?s)/\*\*(?!<| \\)(.*?)\*/", documented, text)
text = re.sub(r"(?m)^(.*[;,{]) */\* (.*?) ?\*/$", lambda f: "%s /**< %s */" % (f[1], re.sub(r"([#@\\<>&%])", r"\\\1", f[2])), text)
sys.stdout.write(text)
