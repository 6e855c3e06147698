"""The server: requests of editors in the Language Server Protocol, answered from a `Workspace`."""

from __future__ import annotations

import os
from collections.abc import Iterable
from difflib import SequenceMatcher
from pathlib import Path
from typing import Any, Final

from lsprotocol import types as lsp
from pygls import uris
from pygls.exceptions import JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer

from ifgen import resources
from ifgen.diagnostics import Diagnostic, InputError, Source, Span
from ifgen.formatting import formatted, has_style
from ifgen.language_server import actions, completion, outline, rename
from ifgen.language_server.hover import hover
from ifgen.language_server.positions import Positions
from ifgen.language_server.symbols import Symbol, definition_of, member_span, named_at, symbol_at
from ifgen.language_server.workspace import Workspace

RULES_PAGE: Final = "https://github.com/ifgen-ros/ifgen/blob/main/docs/rules.md"
_SEVERITIES: Final = {"error": lsp.DiagnosticSeverity.Error, "warning": lsp.DiagnosticSeverity.Warning}
_WATCHED: Final = ("**/*.{msg,srv,action,idl}", "**/*.nodl.{yaml,yml,json}", "**/package.xml")
_WATCHED_NAMES: Final = ("**/CMakeLists.txt", "**/pyproject.toml")


class Server(LanguageServer):
    """A server for one workspace, in the process that an editor starts."""

    def __init__(self) -> None:
        # pyright: ignore is for pygls, whose own keywords may be anything.
        super().__init__(  # pyright: ignore[reportUnknownMemberType]
            "ifgen", resources.VERSION, text_document_sync_kind=lsp.TextDocumentSyncKind.Full
        )
        self.files = Workspace(Path.cwd())
        self._published: set[str] = set()

    def source(self, uri: str) -> Source | None:
        """The text of a document, if it is a file that can be read."""
        path = path_of(uri)
        return self.files.source(path) if path is not None else None

    def positions(self, source: Source) -> Positions:
        """The places of a text in the units of the client."""
        return Positions(source.text, str(self.workspace.position_encoding))

    def location(self, span: Span) -> lsp.Location:
        """A place in a file."""
        place = self.positions(span.source).range(span.start, span.end)
        return lsp.Location(span.source.path.absolute().as_uri(), place)

    def symbol(self, uri: str, position: lsp.Position) -> Symbol | None:
        """The symbol at a position."""
        source = self.source(uri)
        if source is None:
            return None
        return symbol_at(self.files, source, self.positions(source).offset(position))

    def named(self, uri: str, position: lsp.Position) -> Symbol | None:
        """The symbol whose own name is at a position."""
        source = self.source(uri)
        if source is None:
            return None
        return named_at(self.files, source, self.positions(source).offset(position))

    @property
    def pulls(self) -> bool:
        """Whether the client asks for diagnostics; then none of an open document is sent unasked."""
        document = self.client_capabilities.text_document
        return document is not None and document.diagnostic is not None

    def diagnostics(self, found: Iterable[Diagnostic]) -> dict[str, list[lsp.Diagnostic]]:
        """Findings by the document that they are about."""
        by_uri: dict[str, list[lsp.Diagnostic]] = {}
        for finding in found:
            if finding.primary is not None:
                uri = finding.primary.span.source.path.absolute().as_uri()
                by_uri.setdefault(uri, []).append(self._diagnostic(finding))
        return by_uri

    def publish(self, uri: str, found: Iterable[Diagnostic]) -> None:
        """Send what was found to a client that does not ask, and of other files to any client."""
        by_uri = self.diagnostics(found)
        targets = {uri, *by_uri, *self._published}
        for target in sorted(targets):
            path = path_of(target)
            if self.pulls and path is not None and path in self.files.buffers.texts:
                continue
            items = by_uri.get(target, [])
            self.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(target, items))
        self._published = set(by_uri)

    def _diagnostic(self, finding: Diagnostic) -> lsp.Diagnostic:
        assert finding.primary is not None
        help = f"\nhelp: {finding.help}" if finding.help else ""
        label = f": {finding.primary.text}" if finding.primary.text else ""
        related = [
            lsp.DiagnosticRelatedInformation(self.location(each.span), each.text or "see here")
            for each in finding.secondary
        ]
        tags = [lsp.DiagnosticTag.Unnecessary] if finding.rule == "unused-ignore" else None
        return lsp.Diagnostic(
            range=self.location(finding.primary.span).range,
            message=f"{finding.message}{label}{help}",
            severity=_SEVERITIES[finding.severity],
            code=finding.rule,
            code_description=lsp.CodeDescription(f"{RULES_PAGE}#{finding.rule}"),
            source="ifgen",
            tags=tags,
            related_information=related or None,
        )


def path_of(uri: str) -> Path | None:
    """The path of a document; None if it is no file."""
    found = uris.to_fs_path(uri)
    return Path(found) if found else None


def make_server() -> Server:  # noqa: PLR0915 - one function for each request
    """A server with all that it answers."""
    server = Server()

    @server.feature(lsp.INITIALIZED)
    def initialized(_: lsp.InitializedParams) -> None:
        folders = server.workspace.folders or {}
        root = next((path_of(uri) for uri in folders), None) or path_of(server.workspace.root_uri or "")
        if root is not None and root.is_dir():
            os.chdir(root)  # where the configuration is looked for, as by all commands
            server.files = Workspace(root)
        watched = server.client_capabilities.workspace
        if (
            watched
            and watched.did_change_watched_files
            and watched.did_change_watched_files.dynamic_registration
        ):
            watchers = [lsp.FileSystemWatcher(pattern) for pattern in (*_WATCHED, *_WATCHED_NAMES)]
            options = lsp.DidChangeWatchedFilesRegistrationOptions(watchers)
            registration = lsp.Registration("files", lsp.WORKSPACE_DID_CHANGE_WATCHED_FILES, options)
            server.client_register_capability(lsp.RegistrationParams([registration]))

    def changed(uri: str) -> None:
        path = path_of(uri)
        if path is None:
            return
        server.files.open(path, server.workspace.get_text_document(uri).source)
        server.publish(uri, server.files.findings(path))

    @server.feature(lsp.TEXT_DOCUMENT_DID_OPEN)
    def did_open(params: lsp.DidOpenTextDocumentParams) -> None:
        changed(params.text_document.uri)

    @server.feature(lsp.TEXT_DOCUMENT_DID_CHANGE)
    def did_change(params: lsp.DidChangeTextDocumentParams) -> None:
        changed(params.text_document.uri)

    @server.feature(lsp.TEXT_DOCUMENT_DID_CLOSE)
    def did_close(params: lsp.DidCloseTextDocumentParams) -> None:
        path = path_of(params.text_document.uri)
        if path is not None:
            server.files.close(path)

    @server.feature(lsp.TEXT_DOCUMENT_DID_SAVE)
    def did_save(params: lsp.DidSaveTextDocumentParams) -> None:
        server.publish(params.text_document.uri, server.files.all_findings())

    @server.feature(lsp.WORKSPACE_DID_CHANGE_WATCHED_FILES)
    def did_change_files(_: lsp.DidChangeWatchedFilesParams) -> None:
        server.files.files_changed()
        if server.pulls:
            server.workspace_diagnostic_refresh(None)

    @server.feature(
        lsp.TEXT_DOCUMENT_DIAGNOSTIC,
        lsp.DiagnosticOptions(inter_file_dependencies=True, workspace_diagnostics=False, identifier="ifgen"),
    )
    def pull(params: lsp.DocumentDiagnosticParams) -> lsp.RelatedFullDocumentDiagnosticReport:
        uri = params.text_document.uri
        path = path_of(uri)
        found = server.files.findings(path) if path is not None else []
        wanted = path.absolute().as_uri() if path is not None else uri
        return lsp.RelatedFullDocumentDiagnosticReport(items=server.diagnostics(found).get(wanted, []))

    @server.feature(lsp.TEXT_DOCUMENT_HOVER)
    def hovered(params: lsp.HoverParams) -> lsp.Hover | None:
        symbol = server.symbol(params.text_document.uri, params.position)
        text = hover(server.files, symbol) if symbol is not None else None
        if symbol is None or text is None:
            return None
        markdown = lsp.MarkupContent(lsp.MarkupKind.Markdown, text)
        return lsp.Hover(markdown, server.location(symbol.span).range)

    @server.feature(lsp.TEXT_DOCUMENT_DEFINITION)
    def definition(params: lsp.DefinitionParams) -> lsp.Location | None:
        symbol = server.symbol(params.text_document.uri, params.position)
        span = definition_of(server.files, symbol) if symbol is not None else None
        return server.location(span) if span is not None else None

    @server.feature(lsp.TEXT_DOCUMENT_REFERENCES)
    def references(params: lsp.ReferenceParams) -> list[lsp.Location]:
        symbol = server.symbol(params.text_document.uri, params.position)
        if symbol is None:
            return []
        if symbol.kind != "type":
            span = member_span(server.files, symbol)
            return [server.location(span)] if span is not None else []
        found = [server.location(use.span) for use in server.files.uses(symbol.type_name)]
        own = definition_of(server.files, symbol)
        if params.context.include_declaration and own is not None:
            found.insert(0, server.location(own))
        return found

    @server.feature(lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    def document_symbols(params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
        source = server.source(params.text_document.uri)
        if source is None:
            return []
        return outline.document_symbols(server.files, source, server.positions(source))

    @server.feature(lsp.WORKSPACE_SYMBOL)
    def workspace_symbols(params: lsp.WorkspaceSymbolParams) -> list[lsp.WorkspaceSymbol]:
        wanted = params.query.lower()
        found: list[lsp.WorkspaceSymbol] = []
        for interface, name, member in outline.all_names(server.files):
            span = member.span if member is not None else interface.span
            if wanted not in name.lower() or interface.source is None:
                continue
            kind = lsp.SymbolKind.Struct if member is None else lsp.SymbolKind.Field
            place = server.location(span or Span(interface.source, 0, 0))
            found.append(lsp.WorkspaceSymbol(place, name, kind, container_name=interface.type_name))
        return found[:500]

    @server.feature(lsp.TEXT_DOCUMENT_FOLDING_RANGE)
    def folding(params: lsp.FoldingRangeParams) -> list[lsp.FoldingRange]:
        source = server.source(params.text_document.uri)
        return outline.folding_ranges(server.positions(source)) if source is not None else []

    @server.feature(
        lsp.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL,
        lsp.SemanticTokensLegend(list(outline.TOKEN_TYPES), []),
    )
    def semantic_tokens(params: lsp.SemanticTokensParams) -> lsp.SemanticTokens:
        source = server.source(params.text_document.uri)
        if source is None:
            return lsp.SemanticTokens([])
        return lsp.SemanticTokens(outline.semantic_tokens(server.files, source, server.positions(source)))

    @server.feature(lsp.TEXT_DOCUMENT_INLAY_HINT)
    def inlay_hints(params: lsp.InlayHintParams) -> list[lsp.InlayHint]:
        source = server.source(params.text_document.uri)
        if source is None:
            return []
        first, last = params.range.start.line, params.range.end.line
        return outline.inlay_hints(server.files, source, server.positions(source), first, last)

    @server.feature(lsp.TEXT_DOCUMENT_COMPLETION, lsp.CompletionOptions(trigger_characters=["/", ":"]))
    def complete(params: lsp.CompletionParams) -> list[lsp.CompletionItem]:
        source = server.source(params.text_document.uri)
        if source is None:
            return []
        positions = server.positions(source)
        number = params.position.line
        start = positions.start(min(number, positions.lines - 1))
        line = source.text[start : positions.offset(params.position)]
        above = [positions.line(each) for each in range(number)]
        return completion.completions(server.files, source, line, above)

    @server.feature(lsp.TEXT_DOCUMENT_CODE_ACTION, lsp.CodeActionOptions([lsp.CodeActionKind.QuickFix]))
    def code_actions(params: lsp.CodeActionParams) -> list[lsp.CodeAction]:
        path = path_of(params.text_document.uri)
        if path is None:
            return []
        found: list[lsp.CodeAction] = []
        with server.files.buffers.read_first(server.files.root):
            for finding in server.files.findings(path):
                if finding.primary is None or not _is_in(server, finding, path, params.range):
                    continue
                [diagnostic] = [each for all_ in server.diagnostics([finding]).values() for each in all_]
                for title, texts, preferred in actions.quick_fixes(finding):
                    edit = _edit_of(server, texts)
                    found.append(
                        lsp.CodeAction(
                            title,
                            lsp.CodeActionKind.QuickFix,
                            [diagnostic],
                            is_preferred=preferred,
                            edit=edit,
                        )
                    )
        return found

    @server.feature(lsp.TEXT_DOCUMENT_FORMATTING)
    def formatting(params: lsp.DocumentFormattingParams) -> list[lsp.TextEdit]:
        source = server.source(params.text_document.uri)
        if source is None or not has_style(source.path):
            return []
        try:
            text = formatted(source)
        except InputError:
            return []
        return [] if text == source.text else _line_edits(server, source, text)

    @server.feature(lsp.TEXT_DOCUMENT_PREPARE_RENAME)
    def prepare_rename(params: lsp.PrepareRenameParams) -> lsp.PrepareRenamePlaceholder | None:
        symbol = server.named(params.text_document.uri, params.position)
        if symbol is None or not rename.can_rename(server.files, symbol):
            return None
        span = symbol.span
        name = span.source.text[span.start : span.end]
        return lsp.PrepareRenamePlaceholder(server.location(span).range, name)

    @server.feature(lsp.TEXT_DOCUMENT_RENAME, lsp.RenameOptions(prepare_provider=True))
    def renamed(params: lsp.RenameParams) -> lsp.WorkspaceEdit | None:
        symbol = server.named(params.text_document.uri, params.position)
        if symbol is None or not rename.can_rename(server.files, symbol):
            raise JsonRpcInvalidParams("only what the workspace defines can be renamed")
        try:
            renaming = rename.renaming_of(server.files, symbol, params.new_name)
        except InputError as error:
            raise JsonRpcInvalidParams("; ".join(each.message for each in error.diagnostics)) from None
        if renaming.python:
            text = f"{rename.summary(renaming)}:\n{rename.python_places(renaming)}"
            server.window_log_message(lsp.LogMessageParams(lsp.MessageType.Warning, text))
        return _workspace_edit(server, renaming)

    @server.command(completion.DECLARE)
    def declare(uri: str, package: str) -> None:
        path = path_of(uri)
        own = server.files.package_of(path) if path is not None else None
        if own is None:
            return
        with server.files.buffers.read_first(server.files.root):
            texts = actions.dependency_texts(own.root.absolute(), package)
            if texts:
                edit = _edit_of(server, texts)
                server.workspace_apply_edit(
                    lsp.ApplyWorkspaceEditParams(edit, f"depend on {package}"), lambda _: None
                )

    return server


def _is_in(server: Server, finding: Diagnostic, path: Path, place: lsp.Range) -> bool:
    """Whether a finding is at a range of a file."""
    assert finding.primary is not None
    if finding.primary.span.source.path.absolute() != path:
        return False
    own = server.location(finding.primary.span).range
    return own.start.line <= place.end.line and own.end.line >= place.start.line


def _edit_of(server: Server, texts: dict[Path, str]) -> lsp.WorkspaceEdit:
    """An edit that gives files new texts, with as few changed lines as it takes."""
    changes: dict[str, list[lsp.TextEdit]] = {}
    for path, text in texts.items():
        source = server.files.source(path.absolute())
        if source is not None:
            changes[path.absolute().as_uri()] = _line_edits(server, source, text.replace("\r\n", "\n"))
    return lsp.WorkspaceEdit(changes=changes)


def _line_edits(server: Server, source: Source, text: str) -> list[lsp.TextEdit]:
    """The changed lines between the text of a file and a new one."""
    before, after = source.text.splitlines(keepends=True), text.splitlines(keepends=True)
    positions = server.positions(source)
    starts = [0]
    for line in before:
        starts.append(starts[-1] + len(line))
    edits: list[lsp.TextEdit] = []
    for tag, start, end, new_start, new_end in SequenceMatcher(None, before, after, False).get_opcodes():
        if tag != "equal":
            place = positions.range(starts[start], starts[end])
            edits.append(lsp.TextEdit(place, "".join(after[new_start:new_end])))
    return edits


def _workspace_edit(server: Server, renaming: rename.Renaming) -> lsp.WorkspaceEdit:
    """The edit of a new name, which the client shows first if it breaks others and the client can."""
    note = "rename"
    changes: list[Any] = []
    for path, edits in renaming.edits.items():
        source = server.files.source(path)
        if source is None:
            continue
        positions = server.positions(source)
        items: list[lsp.TextEdit | lsp.AnnotatedTextEdit | lsp.SnippetTextEdit] = [
            lsp.AnnotatedTextEdit(note, positions.range(each.start, each.end), each.text)
            for each in edits.values()
        ]
        document = lsp.OptionalVersionedTextDocumentIdentifier(path.as_uri())
        changes.append(lsp.TextDocumentEdit(document, items))
    for old, new in renaming.moves.items():
        changes.append(lsp.RenameFile(old.as_uri(), new.as_uri(), annotation_id=note))
    annotation = lsp.ChangeAnnotation(
        rename.summary(renaming),
        needs_confirmation=bool(renaming.breaking),
        description="; ".join(each.message for each in renaming.breaking) or None,
    )
    return lsp.WorkspaceEdit(document_changes=changes, change_annotations={note: annotation})
