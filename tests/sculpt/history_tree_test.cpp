#include "sculpt/history_tree.h"

#include <gtest/gtest.h>

#include <functional>

#include "implicit/errors.h"

namespace restroke::sculpt {
namespace {

/// 0 - 1 - 2 - 3, and 4 and 5 below 1: 4 - 5. The cursor is at 5.
HistoryTree forked() {
  HistoryTree tree;
  for (int i = 0; i < 3; ++i) tree.add();
  tree.moveCursor(NodeId{1});
  tree.add();
  tree.add();
  return tree;
}

std::vector<std::uint32_t> numbers(const std::vector<NodeId>& nodes) {
  std::vector<std::uint32_t> all;
  for (const NodeId node : nodes) all.push_back(indexOf(node));
  return all;
}

std::vector<std::uint32_t> childrenOf(const HistoryTree& tree, std::uint32_t node) {
  std::vector<std::uint32_t> all;
  for (NodeId child = tree.firstChild(NodeId{node}); child != kRootNode; child = tree.nextSibling(child))
    all.push_back(indexOf(child));
  return all;
}

using Numbers = std::vector<std::uint32_t>;

TEST(HistoryTree, S8ABranchListsParentsBeforeChildrenAndEldersFirst) {
  const HistoryTree tree = forked();
  EXPECT_EQ(numbers(tree.branch(kRootNode)), (Numbers{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(numbers(tree.branch(NodeId{4})), (Numbers{4, 5}));
  EXPECT_TRUE(tree.isInBranch(NodeId{5}, NodeId{1}));
  EXPECT_TRUE(tree.isInBranch(NodeId{5}, NodeId{5}));
  EXPECT_FALSE(tree.isInBranch(NodeId{5}, NodeId{2}));
}

TEST(HistoryTree, S8ACancelledNodeStaysWhereItIs) {
  HistoryTree tree = forked();
  tree.cancel(NodeId{4});
  EXPECT_TRUE(tree.isCancelled(NodeId{4}));
  EXPECT_FALSE(tree.isCancelled(NodeId{5}));
  EXPECT_EQ(numbers(tree.pathTo(NodeId{5})), (Numbers{1, 4, 5}));
  EXPECT_EQ(tree.cursor(), NodeId{5});
  tree.restore(NodeId{4});
  EXPECT_FALSE(tree.isCancelled(NodeId{4}));
}

TEST(HistoryTree, S8ABranchIsCancelledAsAWholeWhateverOfItIsAlready) {
  HistoryTree tree = forked();
  tree.cancel(NodeId{3});
  tree.cancel(NodeId{1}, Extent::Branch);
  for (std::uint32_t i = 1; i < 6; ++i) EXPECT_TRUE(tree.isCancelled(NodeId{i})) << i;
  EXPECT_THROW(tree.cancel(NodeId{1}, Extent::Branch), InputError);
  tree.restore(NodeId{2}, Extent::Branch);
  EXPECT_FALSE(tree.isCancelled(NodeId{3}));
  EXPECT_TRUE(tree.isCancelled(NodeId{4}));
}

TEST(HistoryTree, S8AMovedBranchLiesAheadOfItsNewParentAndTheCursorStaysBehind) {
  HistoryTree tree = forked();
  tree.move(NodeId{4}, NodeId{3});
  EXPECT_EQ(tree.cursor(), NodeId{1});  // was in what moved
  EXPECT_EQ(childrenOf(tree, 1), (Numbers{2}));
  EXPECT_EQ(childrenOf(tree, 3), (Numbers{4}));
  EXPECT_EQ(numbers(tree.pathTo(NodeId{5})), (Numbers{1, 2, 3, 4, 5}));
  // The child last visited has gone: the oldest is next.
  EXPECT_EQ(tree.redoTarget(NodeId{1}), NodeId{2});
}

TEST(HistoryTree, S8MovingElsewhereLeavesTheCursorWhereItIs) {
  HistoryTree tree = forked();
  tree.move(NodeId{2}, NodeId{5});
  EXPECT_EQ(tree.cursor(), NodeId{5});
  EXPECT_EQ(tree.redoTarget(NodeId{5}), NodeId{2});
  EXPECT_EQ(numbers(tree.pathTo(NodeId{3})), (Numbers{1, 4, 5, 2, 3}));
}

TEST(HistoryTree, S8ASingleNodeIsMovedFromBetweenItsParentAndItsChildren) {
  HistoryTree tree = forked();
  tree.move(NodeId{1}, NodeId{3}, Extent::Single);
  EXPECT_EQ(childrenOf(tree, 0), (Numbers{2, 4}));
  EXPECT_EQ(childrenOf(tree, 3), (Numbers{1}));
  EXPECT_EQ(childrenOf(tree, 1), (Numbers{}));
  EXPECT_EQ(tree.cursor(), NodeId{5});
  EXPECT_EQ(numbers(tree.pathTo(NodeId{5})), (Numbers{4, 5}));
  // Redo goes on where it would have gone through the node.
  tree.moveCursor(kRootNode);
  EXPECT_EQ(tree.redoTarget(kRootNode), NodeId{4});
}

TEST(HistoryTree, S8ACopyHasNewNumbersInTheOrderOfItsSource) {
  HistoryTree tree = forked();
  tree.cancel(NodeId{3});
  EXPECT_EQ(numbers(tree.copy(NodeId{1}, NodeId{5})), (Numbers{1, 2, 3, 4, 5}));
  EXPECT_EQ(tree.size(), 11u);
  EXPECT_EQ(childrenOf(tree, 5), (Numbers{6}));
  EXPECT_EQ(childrenOf(tree, 6), (Numbers{7, 9}));
  EXPECT_EQ(childrenOf(tree, 7), (Numbers{8}));
  EXPECT_EQ(childrenOf(tree, 9), (Numbers{10}));
  EXPECT_TRUE(tree.isCancelled(NodeId{8}));
  EXPECT_FALSE(tree.isCancelled(NodeId{7}));
  EXPECT_EQ(tree.cursor(), NodeId{5});
  EXPECT_EQ(numbers(tree.copy(NodeId{1}, kRootNode, Extent::Single)), (Numbers{1}));
  EXPECT_EQ(childrenOf(tree, 0), (Numbers{1, 11}));
  EXPECT_EQ(childrenOf(tree, 11), (Numbers{}));
}

TEST(HistoryTree, RefusesWhatCannotBeInOneSentenceAndStaysAsItWas) {
  const struct {
    std::function<void(HistoryTree&)> edit;
    const char* sentence;
  } cases[] = {
      {[](HistoryTree& t) { t.moveCursor(NodeId{9}); },
       "goto: node 9 does not exist, but must be one of 0 to 5"},
      {[](HistoryTree& t) { t.cancel(NodeId{6}); },
       "cancel: node 6 does not exist, but must be one of 0 to 5"},
      {[](HistoryTree& t) { t.cancel(kRootNode); },
       "cancel: node 0 is the root, which is the base and no command, but a node from 1 on is needed"},
      {[](HistoryTree& t) { t.restore(NodeId{2}); }, "restore: node 2 is not cancelled, but must be"},
      {[](HistoryTree& t) { t.move(kRootNode, NodeId{2}); },
       "move: node 0 is the root, which is the base and no command, but a node from 1 on is needed"},
      {[](HistoryTree& t) { t.move(NodeId{1}, NodeId{5}); },
       "move: node 5 lies in the branch of node 1, but a branch cannot hang from itself"},
      {[](HistoryTree& t) { t.move(NodeId{3}, NodeId{3}, Extent::Single); },
       "move: node 3 cannot become a child of itself"},
      {[](HistoryTree& t) { t.move(NodeId{3}, NodeId{7}); },
       "move: node 7 does not exist, but must be one of 0 to 5"},
      {[](HistoryTree& t) { (void)t.copy(kRootNode, NodeId{2}); },
       "copy: node 0 is the root, which is the base and no command, but a node from 1 on is needed"},
      {[](HistoryTree& t) { (void)t.copy(NodeId{2}, NodeId{8}); },
       "copy: node 8 does not exist, but must be one of 0 to 5"}};
  for (const auto& one : cases) {
    HistoryTree tree = forked();
    try {
      one.edit(tree);
      ADD_FAILURE() << "was taken, not refused: " << one.sentence;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()), one.sentence);
    }
    EXPECT_EQ(tree.size(), 6u);
    EXPECT_EQ(tree.cursor(), NodeId{5});
    EXPECT_EQ(numbers(tree.branch(kRootNode)), (Numbers{0, 1, 2, 3, 4, 5}));
  }
  HistoryTree tree = forked();
  tree.cancel(NodeId{2});
  try {
    tree.cancel(NodeId{2});
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()), "cancel: node 2 is cancelled already, but must not be");
  }
}

}  // namespace
}  // namespace restroke::sculpt
