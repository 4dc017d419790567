"""manual_filter.py HEADER: the header as Doxygen is to read it. Its comments have columns, which stay as they are; the first sentence
is the brief one. Comments of /* behind a declaration or a member are those of that, too."""

import re
import sys

text = open(sys.argv[1], encoding="utf-8").read()


def brief_of(body):
    """The first sentence, or what is before a list."""
    sentence = re.split(r"(?<=\.)\s|(?<=:)\n|\n\n", body, maxsplit=1)[0]
    return re.sub(r"([#@\\<>&%])", r"\\\1", " ".join(sentence.split()))


def documented(found):
    lines = [re.sub(r"^\s*\* ?", "", line) for line in found[1].strip().split("\n")]
    body = "\n".join(lines)
    brief = brief_of(body)
    # as many lines as before, so that line numbers stay
    return "/** %s\\verbatim %s \\endverbatim */" % (brief + "\n\n" if len(lines) > 1 else "", body) if len(lines) > 1 else "/** %s */" % brief


def page(found):
    """The opening comment: of brio.h the first page of the manual, of another header its own page."""
    body = "\n".join(re.sub(r"^ \* ?", "", line) for line in found[1].strip().split("\n"))
    name, _, rest = body.partition(": ")
    command = "\\mainpage The manual" if name == "brio" else "\\file %s \\brief %s" % (name, brief_of(rest))
    return "/** %s\n\n\\verbatim %s \\endverbatim */" % (command, body)


text = re.sub(r"(?s)\A/\*(.*?)\*/", page, text)
text = re.sub(r"(?s)/\*\*(?!<| \\)(.*?)\*/", documented, text)
text = re.sub(r"(?m)^(.*[;,{]) */\* (.*?) ?\*/$", lambda f: "%s /**< %s */" % (f[1], re.sub(r"([#@\\<>&%])", r"\\\1", f[2])), text)
sys.stdout.write(text)
